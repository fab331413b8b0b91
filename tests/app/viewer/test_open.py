"""The viewer: what is shown of which file, a live view that never waits, a recording seen again."""

import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray

from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.app.text.amplitude_units import AmplitudeUnit
from rotorrig.app.viewer.live.parts.blueprint import TABS
from rotorrig.app.viewer.open import Evidence, LiveView, as_rrd, view_file, write_recording_rrd
from rotorrig.app.viewer.plots.axes import LIFT, Panel
from rotorrig.app.viewer.result.opening import TIMELINE, read_opening
from rotorrig.app.viewer.sinks import free_port, move_cursor, serve, to_file
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError, RigError
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.app.headless import headless_viewer, marked, needs_vulkan, show_tab, views
from tests.app.viewer.rrd_content import chunks, words_in

BLUE, ORANGE, GREEN, WHITE = (74, 163, 223), (242, 142, 43), (126, 200, 120), (240, 240, 240)


Swept = tuple[NDArray[np.int32], DaqInfo]


def blocks_of(swept: Swept, *, size: int = 200) -> list[Block]:
    counts, info = swept
    return [
        Block(counts=counts[i : i + size], first_sample=i, t_ns=round(i * 1e9 / info.sample_rate))
        for i in range(0, len(counts), size)
    ]


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


@pytest.mark.campaign
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


def test_a_served_viewer_listens_on_this_machine_alone_and_ends_with_its_sink(tmp_path: Path) -> None:
    with serve(save=tmp_path / "live.rrd", headless=True) as sink:
        assert sink.viewer is not None
        ports = psutil.Process(sink.viewer.pid).net_connections("inet")
        assert len([port for port in ports if port.status == psutil.CONN_LISTEN]) == 2
        assert {port.laddr.ip for port in ports} == {"127.0.0.1"}
        assert sink.address.startswith("http://127.0.0.1:")
    assert sink.viewer.poll() is not None


@pytest.mark.viewer
@needs_vulkan
def test_the_cursor_of_a_viewer_is_moved_where_a_file_says(tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "response.mcap", response)
    made = as_rrd(tmp_path / "response.mcap", tmp_path)
    rpm, port = read_opening(made), free_port()
    assert rpm == pytest.approx(2230, abs=30)  # no diagnosis: the largest vector
    with headless_viewer(port=port) as viewer:
        viewer.open(str(made))
        assert move_cursor(port, TIMELINE, rpm)
        (shown,) = viewer.get_state().recordings
        assert (shown.current_timeline, shown.current_time) == (TIMELINE, rpm)


def test_the_cursor_of_a_viewer_that_was_closed_is_let_go() -> None:
    assert not move_cursor(free_port(), TIMELINE, 2230, alive=lambda: False)


@pytest.fixture
def recording(rig: RigConfig, swept: Swept, response: OrderTrackedResponse) -> RawRecording:
    events = (Event(t_ns=10**9, kind="mark", text="up"), Event(t_ns=11 * 10**9, kind="trip", text="too much"))
    plan = rig.plans["default"].model_copy(update={"slow_roll": 480 * np.pi / 30})  # the run's first second
    return RawRecording(
        rig=rig.model_copy(update={"plans": {"default": plan}}),
        daq=swept[1],
        blocks=tuple(blocks_of(swept)),
        events=events,
        motor=(),
        source=response.source,
        complete=True,
    )


def test_a_recording_is_drawn_in_the_unit_asked_for(recording: RawRecording, tmp_path: Path) -> None:
    told, peaks = {}, {}
    for unit in ("µm 0-peak", "mil pp"):
        rrd = tmp_path / f"{unit}.rrd"
        write_recording_rrd(rrd, recording, unit=AmplitudeUnit(unit))
        told[unit], peaks[unit] = words_in(rrd), peak_of(rrd)
    assert "1x: 1X amplitude, less slow roll, mil pp" in told["mil pp"]
    assert {"1x, mil", "x, mil", "y, mil"} < set(told["mil pp"])
    assert not [word for word in told["mil pp"] if "µm" in word]
    assert not [word for word in told["µm 0-peak"] if "mil" in word]
    assert peaks["µm 0-peak"] > 100
    assert peaks["mil pp"] == pytest.approx(peaks["µm 0-peak"] * 2 / 25.4, rel=1e-3)


def peak_of(rrd: Path) -> float:
    """Return the highest point of the Bode plot of 1x by the numbers at its axis."""
    parts = dict(chunks(rrd))
    axis = parts["/bode/1x/amplitude/axes/labels"]
    places, words = axis["Points2D:positions"].to_pylist()[-1], axis["Points2D:labels"].to_pylist()[-1]
    ticks = {float(word): y + LIFT for word, (_, y) in zip(words, places, strict=True) if word.isdigit()}
    top = max(ticks)
    (strips,) = parts["/bode/1x/amplitude/up"]["LineStrips2D:strips"].to_pylist()
    highest = min(y for strip in strips for _, y in strip)
    return top * (ticks[0.0] - highest) / (ticks[0.0] - ticks[top])


def test_a_picture_is_not_drawn_in_another_unit(tmp_path: Path, response: OrderTrackedResponse) -> None:
    in_mil = Evidence(unit=AmplitudeUnit("mil pp"))
    write_response(tmp_path / "response.mcap", response)
    made = as_rrd(tmp_path / "response.mcap", tmp_path, in_mil)
    assert as_rrd(made, tmp_path) == made
    with pytest.raises(DataError, match=r"response\.rrd: is drawn already, want the run\.mcap or response\.mcap"):
        as_rrd(made, tmp_path, in_mil)


@pytest.mark.campaign
@pytest.mark.viewer
@needs_vulkan
def test_a_recording_is_drawn_whole_with_the_orbit_of_the_time(tmp_path: Path, recording: RawRecording) -> None:
    write_recording_rrd(tmp_path / "run.rrd", recording)
    with headless_viewer() as viewer:
        viewer.open(str(tmp_path / "run.rrd"))
        time.sleep(1.0)  # until its layout is there
        viewer.set_time(timeline="time", duration=6.0, play_state="paused")
        seen = {}
        for tab in TABS:
            show_tab(viewer, tab)
            seen |= views(viewer, tmp_path, but_hidden=True)
    for name, picture in seen.items():
        blue, orange, green = (pixels(picture, colour) for colour in (BLUE, ORANGE, GREEN))
        if name.startswith(("Bode", "Polar", "Shaft centreline")):
            assert blue > 60 and orange > 60, name  # up to 3000 rpm and down to 1500, though it is not yet 6 s
            assert not name.startswith("Bode") or pixels(picture, WHITE) > 10, f"{name}: no dot at the present vector"
        elif name.startswith("Cascade"):
            assert (blue if name.endswith("up") else orange) > 1000, name
        elif name.startswith("Orbit") or name.endswith("less slow roll"):
            assert green > 100 and pixels(picture, WHITE) > 10, name
        elif name.startswith("Time base"):
            assert blue > 100 and pixels(picture, WHITE) > 10, name
        else:
            assert np.ptp(picture) > 100, name


def pixels(picture: np.ndarray, colour: tuple[int, int, int], *, within: int = 30) -> int:
    return int(marked(picture, colour, within=within).sum())
