"""`run.mcap` and `response.mcap` opened as they are in the Rerun viewer, not converted by this program."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping
from rerun.experimental import ViewerClient

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.recording import MotorSample, RawRecording
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.app.headless import headless_viewer, marked, needs_vulkan, views

BLUE = (74, 163, 223)
GREEN = (0, 200, 120)
ALWAYS = rr.TimeRangeBoundary.infinite()
WHOLE = rrb.TimeAxis(view_range=rr.TimeRange(ALWAYS, ALWAYS))

pytestmark = [pytest.mark.viewer, needs_vulkan]


@pytest.fixture(scope="module")
def viewer() -> Iterator[ViewerClient]:
    with headless_viewer() as client:
        yield client


def plot(topic: str, *, name: str, field: str = "", schema: str = "") -> rrb.TimeSeriesView:
    """Return a plot of a topic: of one field in blue, or of what Rerun finds in it."""
    line = rr.SeriesLines(colors=BLUE, widths=2).visualizer(
        mappings=[
            VisualizerComponentMapping(
                "Scalars:scalars",
                ComponentSourceKind.SourceComponent,
                source_component=f"rotorrig.{schema}:message",
                selector=f".{field}",
            )
        ]
    )
    return rrb.TimeSeriesView(
        origin=topic,
        name=name,
        axis_x=WHOLE,
        plot_legend=rrb.PlotLegend(visible=False),
        overrides={topic: line} if field else None,
    )


def seen(viewer: ViewerClient, file: Path, *plots: rrb.TimeSeriesView) -> dict[str, NDArray[np.int_]]:
    """Open a file, lay out the plots and return what each of them shows."""
    (opened,) = viewer.open(str(file)).store_ids
    layout = rr.RecordingStream(file.stem)  # Rerun names what it opens after the file
    layout.connect_grpc(viewer.url)
    layout.send_blueprint(rrb.Blueprint(rrb.Grid(*plots)))
    layout.flush()
    layout.disconnect()
    viewer.set_location(next(r.location for r in viewer.get_state().recordings if r.store_id == opened))
    viewer.set_time(play_state="paused")
    deadline = time.monotonic() + 10.0
    while len(viewer.get_state().views) < len(plots) and time.monotonic() < deadline:
        time.sleep(0.1)
    time.sleep(1.0)  # to draw them
    pictures = views(viewer, file.parent)
    assert len(pictures) == len(plots)
    assert [entry.message for entry in viewer.get_logs() if entry.level != "INFO"] == []
    return pictures


def coloured(picture: NDArray[np.int_]) -> int:
    """Return the number of pixels that are not grey, as axes, grid and time cursor are."""
    return int((np.ptp(picture, axis=2) > 40).sum())


def curve(picture: NDArray[np.int_]) -> tuple[NDArray[np.float64], NDArray[np.int_]]:
    """Return the blue curve's columns, from 0 at its first to 1 at its last, and its height in each."""
    blue = marked(picture, BLUE)
    columns = np.flatnonzero(blue.any(axis=0))
    return (columns - columns[0]) / np.ptp(columns), len(blue) - blue[:, columns].argmax(axis=0)


@pytest.mark.campaign
def test_a_response_is_plotted(viewer: ViewerClient, tmp_path: Path, response: OrderTrackedResponse) -> None:
    write_response(tmp_path / "response.mcap", response)
    pictures = seen(
        viewer,
        tmp_path / "response.mcap",
        plot("/bode/1x/1X", name="amplitude", schema="OrderVector", field="amplitude_um"),
        plot("/bode/1x/1X", name="what Rerun finds"),
        plot("/response", name="no numbers"),
    )
    assert coloured(pictures["what Rerun finds"]) > 2000  # amplitude and phase, raw and compensated
    assert coloured(pictures["no numbers"]) < 20  # the edge of the plot beside it
    at, height = curve(pictures["amplitude"])
    for run in (1, 2):  # up, down
        t, z = response.t[response.run == run], response.z[response.run == run, 0, 1]
        during = (at > t[0] / response.t[-1]) & (at < t[-1] / response.t[-1])
        peak = at[during][height[during].argmax()]
        assert peak == pytest.approx(t[np.abs(z).argmax()] / response.t[-1], abs=0.01)


def test_a_response_opens_by_itself_with_its_orbits_in_place_and_its_log(
    viewer: ViewerClient, tmp_path: Path, response: OrderTrackedResponse
) -> None:
    write_response(tmp_path / "bare.mcap", response)  # under a name for which no layout was sent
    viewer.open(str(tmp_path / "bare.mcap"))
    at_peak = np.datetime64(round(response.t[np.abs(response.z[:, 0, 1]).argmax()] * 1e9), "ns")
    viewer.set_time(timeline="message_log_time", timestamp=at_peak, play_state="paused")
    time.sleep(1.0)
    kinds = [view.view_class for view in viewer.get_state().views]
    assert sorted(kinds) == ["3D", "TextLog"]
    pictures = views(viewer, tmp_path, by_kind=True)
    assert marked(pictures["3D"], BLUE).sum() > 100  # orbits where the speed rises
    assert marked(pictures["TextLog"], GREEN, within=60).sum() > 20  # lines of level INFO


def test_a_recording_opens_and_its_speed_is_plotted(
    viewer: ViewerClient,
    tmp_path: Path,
    rig: RigConfig,
    swept: tuple[NDArray[np.int32], DaqInfo],
    response: OrderTrackedResponse,
) -> None:
    counts, info = swept
    ramp = tuple(
        MotorSample(t_ns=round(t * 1e9), speed=10 * t, setpoint=100.0, running=True, fault="")
        for t in np.arange(0, 10, 0.25)
    )
    block = Block(counts=counts[:2000], first_sample=0, t_ns=0)
    recording = RawRecording(
        rig=rig, daq=info, blocks=(block,), events=(), motor=ramp, source=response.source, complete=True
    )
    write_recording(tmp_path / "run.mcap", recording)
    pictures = seen(
        viewer,
        tmp_path / "run.mcap",
        plot("/motor", name="speed", schema="Motor", field="speed"),
        plot("/motor", name="what Rerun finds"),
    )
    assert coloured(pictures["what Rerun finds"]) > 500
    at, height = curve(pictures["speed"])
    assert np.corrcoef(at, height)[0, 1] > 0.999  # a straight line, rising
