"""Live and result views: the tracking against closed forms, the pictures in a headless viewer."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray
from rerun.experimental import ViewerClient

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.drawn_axes import Panel
from rotorrig.app.live_process import joined
from rotorrig.app.live_tracking import GrowingBode, LiveTracker
from rotorrig.app.result_view import verdict_words
from rotorrig.app.sinks import serve, to_file
from rotorrig.app.viewer import LiveView, as_rrd, view_file, write_recording_rrd, write_result_rrd
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.response_file import write_response
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import DataError, RigError
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.app.headless import headless_viewer, marked, needs_vulkan, views

BLUE, ORANGE, RED = (74, 163, 223), (242, 142, 43), (200, 24, 66)


RAD = np.pi / 30  # rad/s per rpm
Swept = tuple[NDArray[np.int32], DaqInfo]
ClosedForm = Callable[[NDArray[np.float64]], NDArray[np.complex128]]


def blocks_of(swept: Swept, *, size: int = 200) -> list[Block]:
    counts, info = swept
    return [
        Block(counts=counts[i : i + size], first_sample=i, t_ns=round(i * 1e9 / info.sample_rate))
        for i in range(0, len(counts), size)
    ]


def track(rig: RigConfig, info: DaqInfo, blocks: list[Block]) -> tuple[np.ndarray, np.ndarray]:
    tracker = LiveTracker(rig, info)
    turns = [tracker.take(block) for block in blocks]
    return np.concatenate([omega for omega, _ in turns]), np.concatenate([z for _, z in turns])


def test_live_vectors_are_the_closed_form(rig: RigConfig, swept: Swept, closed_form: ClosedForm) -> None:
    blocks, info = blocks_of(swept), swept[1]
    omega, z = track(rig, info, blocks)
    angles = np.array([p.angle for p in rig.probes])
    expected = closed_form(omega)[:, None] * np.exp(-1j * angles)
    assert len(omega) > 400
    assert np.abs(z - expected).max() < 0.02 * np.abs(expected).max()


def test_live_vectors_do_not_depend_on_the_blocks(rig: RigConfig, swept: Swept) -> None:
    blocks, info = blocks_of(swept), swept[1]
    omega, z = track(rig, info, blocks_of(swept, size=1777))
    again, z_again = track(rig, info, blocks)
    assert omega == pytest.approx(again)
    assert z == pytest.approx(z_again)


def test_a_gap_costs_the_turns_it_cuts_and_nothing_else(rig: RigConfig, swept: Swept, closed_form: ClosedForm) -> None:
    blocks, info = blocks_of(swept), swept[1]
    omega, z = track(rig, info, [*blocks[:300], *blocks[310:]])
    angles = np.array([p.angle for p in rig.probes])
    assert np.abs(z - closed_form(omega)[:, None] * np.exp(-1j * angles)).max() < 0.02 * np.abs(z).max()
    assert len(joined([*blocks[:300], *blocks[310:]])) == 2


def test_a_standing_shaft_fills_no_memory(rig: RigConfig, swept: Swept) -> None:
    _, info = swept
    tracker = LiveTracker(rig, info)
    still = np.zeros((10_000, 5), dtype=np.int32)
    for second in range(30):
        tracker.take(Block(counts=still, first_sample=second * 10_000, t_ns=second * 10**9))
    assert tracker.speed == 0
    assert tracker.waveform() is None
    assert len(tracker._counts) <= 10_000


def test_the_bode_plot_tells_rising_from_falling(rig: RigConfig, swept: Swept) -> None:
    blocks, info = blocks_of(swept), swept[1]
    bode = GrowingBode()
    bode.add(*track(rig, info, blocks))
    up, down = bode.arrays(1)[0], bode.arrays(-1)[0]
    assert (np.diff(up) > 0).all()
    assert (np.diff(down) < 0).all()
    assert up[-1] == pytest.approx(3000, abs=30)
    assert down[-1] == pytest.approx(1500, abs=30)


def test_a_dwell_does_not_make_the_bode_plot_grow() -> None:
    bode = GrowingBode()
    rpm = 1000 + np.random.default_rng(0).normal(0, 1, 8000)  # speed hunting of 0.1 %
    bode.add(rpm * RAD, np.ones((8000, 1), dtype=complex))
    assert len(bode.arrays(1)[0]) < 5
    assert len(bode.arrays(-1)[0]) == 0


def test_panel_lines_break_where_a_value_is_missing_or_leaps() -> None:
    panel = Panel(left=0, top=0, width=10, height=10, x=(0, 10), y=(0, 360), x_step=1, y_step=90)
    y = np.array([350.0, 355.0, 2.0, 6.0, np.nan, 10.0, 12.0])
    strips = panel.strips(np.arange(7.0), y, jump=180.0)
    assert [len(strip) for strip in strips] == [2, 2, 2]
    assert strips[0][0] == pytest.approx([0.0, 10 * (1 - 350 / 360)])  # the view's y points down


def test_showing_a_block_never_waits(rig: RigConfig, swept: Swept, tmp_path: Path) -> None:
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        began = time.perf_counter()
        for block in blocks:
            live.show(block)
        per_block = (time.perf_counter() - began) / len(blocks)
    assert per_block < 0.02  # a block lasts 20 ms; it takes microseconds
    assert (live.fault, live.dropped) == ("", 0)
    assert (tmp_path / "live.rrd").stat().st_size > 10_000


def test_a_fault_in_the_view_stays_in_the_view(
    rig: RigConfig, swept: Swept, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        live.show(Block(counts=np.zeros((200, 2), dtype=np.int32), first_sample=0, t_ns=0))  # the config uses five
    assert live.fault
    live.show(blocks[0])
    assert "live view ended" in caplog.text


def test_files_that_cannot_be_shown_are_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "run.mcap").write_text("no MCAP")
    with pytest.raises(DataError, match=r"run\.mcap"):
        view_file(tmp_path / "run.mcap", headless=True)
    with pytest.raises(DataError, match="no such file"):
        view_file(tmp_path / "missing.rrd", headless=True)
    with pytest.raises(RigError, match="no folder"):
        to_file(tmp_path / "missing" / "live.rrd")


def test_a_response_file_becomes_a_picture(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "response.mcap", response)
    made = as_rrd(tmp_path / "response.mcap", tmp_path)
    assert made.stat().st_size > 100_000


def test_the_words_beside_the_pictures_name_the_cause_and_what_it_bought(
    response: OrderTrackedResponse, named: Diagnosis
) -> None:
    words = verdict_words(response, None, named, recorded=False)
    assert words.index("**NAMED**") < words.index(named.causes[0].words)
    assert "| bow | 18.00 ± 0.30 µm at 110.0 ± 1.0° | 812 | 5.20 → 0.410 µm |" in words
    assert "1.03 times the noise floor" in words
    assert "A run with a trial mass" in words


def test_a_served_viewer_listens_on_this_machine_alone_and_ends_with_its_sink(tmp_path: Path) -> None:
    with serve(save=tmp_path / "live.rrd", headless=True) as sink:
        assert sink.viewer is not None
        ports = psutil.Process(sink.viewer.pid).net_connections("inet")
        assert len([port for port in ports if port.status == psutil.CONN_LISTEN]) == 2
        assert {port.laddr.ip for port in ports} == {"127.0.0.1"}
        assert sink.address.startswith("http://127.0.0.1:")
    assert sink.viewer.poll() is not None


@pytest.fixture(scope="module")
def headless() -> Iterator[ViewerClient]:
    with headless_viewer() as viewer:
        yield viewer


def pictures(viewer: ViewerClient, rrd: Path, folder: Path, **at: float) -> dict[str, np.ndarray]:
    """Open a file at a time and return what each view shows, (height, width, 3)."""
    viewer.close("all")
    viewer.open(str(rrd))
    viewer.set_time(**at, play_state="paused")
    time.sleep(1.0)
    return views(viewer, folder)


def pixels(picture: np.ndarray, colour: tuple[int, int, int], *, within: int = 30) -> int:
    return int(marked(picture, colour, within=within).sum())


@pytest.mark.viewer
@needs_vulkan
def test_the_result_is_drawn_in_every_view(
    headless: ViewerClient,
    tmp_path: Path,
    response: OrderTrackedResponse,
    poorly_fitted: Identification,
    poor: Diagnosis,
) -> None:
    write_result_rrd(tmp_path / "demo.rrd", response, poorly_fitted, poor)
    seen = pictures(headless, tmp_path / "demo.rrd", tmp_path, timeline="speed_rpm", sequence=2230)
    assert len(seen) == 8
    for name, picture in seen.items():
        if name.startswith("Bode"):
            # the model lies on both runs and one run on the other: much of the two colours is covered
            assert pixels(picture, BLUE) > 15 and pixels(picture, ORANGE) > 15
            assert pixels(picture, (250, 200, 140)) > 200  # the model
        elif name.startswith("Orbit"):
            assert pixels(picture, BLUE) > 200
            assert pixels(picture, (240, 240, 240)) > 20  # the keyphasor dot
        elif name.startswith("Residual"):
            assert pixels(picture, RED) > 1000
        else:
            assert pixels(picture, (202, 216, 222), within=60) > 300  # words


@pytest.mark.viewer
@needs_vulkan
def test_a_recording_is_drawn_as_it_would_have_looked_live(
    headless: ViewerClient,
    tmp_path: Path,
    rig: RigConfig,
    swept: Swept,
    response: OrderTrackedResponse,
) -> None:
    blocks, info = blocks_of(swept), swept[1]
    recording = RawRecording(
        rig=rig, daq=info, blocks=tuple(blocks), events=(), motor=(), source=response.source, complete=True
    )
    write_recording_rrd(tmp_path / "run.rrd", recording)
    seen = pictures(headless, tmp_path / "run.rrd", tmp_path, timeline="time", duration=16.0)
    assert len(seen) == 8
    for name, picture in seen.items():
        if name.startswith("Bode"):
            assert pixels(picture, BLUE) > 200 and pixels(picture, ORANGE) > 200  # up to 3000 rpm, down to 1500
        else:
            assert pixels(picture, BLUE) > 100, name
