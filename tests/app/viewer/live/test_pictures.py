"""The pictures of the live view: what they compute, and where their marks are on the screen."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
import rerun.blueprint as rrb
from rerun.experimental import ViewerClient

from rotorrig.app.viewer.blueprint import flat, make_blueprint
from rotorrig.app.viewer.live.parts.blueprint import (
    CASCADE_BOUNDS,
    CENTRELINE_BOUNDS,
    TABS,
    live_blueprint,
    replay_blueprint,
)
from rotorrig.app.viewer.live.parts.position import bearing_near
from rotorrig.app.viewer.plots.axes import INK, Panel
from rotorrig.app.viewer.plots.cascade import CascadePicture, visible
from rotorrig.app.viewer.plots.centreline import CentrelinePicture
from rotorrig.app.viewer.plots.scale import FollowingScale
from rotorrig.app.viewer.plots.words import ALSO, SHOWN, displayable
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.errors import ConfigError
from tests.app.headless import headless_viewer, marked, needs_vulkan, views

TITLE = 32  # pixels of a view's own title, with its buttons
Drawing = Callable[[rr.RecordingStream], object]
BLUE, WHITE, GREY = (74, 163, 223), (240, 240, 240), (120, 128, 138)


def names(blueprint: rrb.Blueprint) -> dict[str, list[str]]:
    """Return the names of the views in every tab."""

    def within(part: object) -> list[str]:
        return [str(part.name)] if isinstance(part, rrb.View) else [n for p in part.contents for n in within(p)]  # type: ignore[attr-defined]

    return {str(tab.name): within(tab) for tab in blueprint.root_container.contents}


def test_the_layout_has_its_tabs_and_views_by_name(rig: RigConfig) -> None:
    live, replay = names(live_blueprint(rig)), names(replay_blueprint(rig))
    assert tuple(live) == tuple(replay) == TABS
    assert live["Sweep"] == [
        "Orbit: 1x, 1y at 250.5 mm",
        "Orbit: 2x, 2y at 380.5 mm",
        *(f"Bode, 1X: probe {name}" for name in ("1x", "1y", "2x", "2y")),
        "Speed, rpm",
        "Readings",
    ]
    assert replay["Sweep"] == [*live["Sweep"], "Events"]
    assert live["Orbits"][:4] == [
        "1x, 1y: all orders",
        "1x, 1y: 1X, green less slow roll",
        "1x, 1y: all orders, less slow roll",
        "Time base 1x, 1y, all orders",
    ]
    assert live["Polar"] == [f"Polar, 1X: probe {name}" for name in ("1x", "1y", "2x", "2y")]
    assert live["Position"][0] == "Shaft centreline: 1x, 1y at 250.5 mm"
    assert live["Position"][-1] == "Gap voltage, V, and the ends of the linear range"
    assert live["Spectra"][:2] == ["Cascade 1x, 1y: speed going up", "Cascade 1x, 1y: speed going down"]


def test_a_rig_without_a_plane_of_probes_has_no_orbits(rig: RigConfig) -> None:
    one = rig.model_copy(update={"probes": rig.probes[:1]})
    assert list(names(live_blueprint(one, tab="Polar"))) == ["Sweep", "Polar", "Position"]


def test_a_scale_grows_at_once_and_shrinks_when_most_is_empty() -> None:
    scale = FollowingScale(1.0)
    assert scale.follow(95.0) and scale.value == 100.0
    assert not scale.follow(40.0)
    assert scale.follow(20.0) and scale.value == 30.0
    assert not scale.follow(0.0)  # a shaft that stands has no scale of its own


def test_a_slower_spectrum_hides_what_lies_behind_it() -> None:
    panel = Panel(left=0, top=0, width=4, height=100, x=(0, 4), y=(0, 100), x_step=1, y_step=10)
    order, rpm = np.arange(5.0), np.array([50.0, 40.0])
    height = np.array([[0, 0, 2, 0, 0], [0, 0, 15, 15, 0.0]])
    drawn = dict(visible(panel, rpm, order, height))
    assert [piece.tolist() for piece in drawn[1]] == [[[0, 60], [1, 60], [2, 45], [3, 45], [4, 60]]]
    assert [piece.tolist() for piece in drawn[0]] == [[[0, 50], [1, 50]]]  # 2 and 3 are behind; one point is no line


def test_a_clearance_is_a_length_and_the_nearest_bearings(rig: RigConfig) -> None:
    assert bearing_near(rig, 0.2505).name == "left B"
    assert bearing_near(rig, 0.3805).name == "spring"
    assert bearing_near(rig, 0.3805).clearance is None

    def read(words: str) -> RigConfig:
        return parse(words, where="test")

    text = rig.text.replace('name = "spring"\n', 'name = "spring"\nclearance = "250 um"\n', 1)
    assert read(text).bearing("spring").clearance == pytest.approx(250e-6)
    with pytest.raises(ConfigError, match="clearance"):
        read(text.replace("250 um", "-250 um"))
    with pytest.raises(ConfigError, match="clearance"):
        read(text.replace("250 um", "250 V"))
    assert read(rig.text).hash == read(rig.text + "\n# a remark\n").hash != read(text).hash


def on_screen(viewer: ViewerClient, view: rrb.View, draw: Drawing, folder: Path) -> np.ndarray:
    """Draw into a layout of one view and return the picture."""
    stream = rr.RecordingStream(f"pictures {time.time_ns()}")  # a viewer keeps the layout of each application
    stream.set_sinks(rr.GrpcSink(viewer.url), default_blueprint=make_blueprint(rrb.Horizontal(view), timeline="time"))
    stream.set_time("time", duration=0.0)
    draw(stream)
    stream.flush()
    time.sleep(1.0)
    (picture,) = views(viewer, folder).values()
    stream.disconnect()
    return picture[TITLE:]


def centre(mask: np.ndarray) -> tuple[float, float]:
    rows, columns = np.nonzero(mask)
    return float(columns.mean()), float(rows.mean())


@pytest.mark.campaign
@pytest.mark.viewer
@needs_vulkan
def test_the_marks_are_where_the_closed_form_says(tmp_path: Path) -> None:
    with headless_viewer() as viewer:

        def centreline(stream: rr.RecordingStream) -> None:
            picture = CentrelinePicture(stream, "c", clearance=200.0)
            picture.draw([("up", np.array([[0.0, 0.0], [0.0, 100.0]]), BLUE)])
            picture.dot(np.array([0.0, 100.0]))

        seen = on_screen(viewer, flat("c", "centreline", CENTRELINE_BOUNDS), centreline, tmp_path)
        grey = marked(seen, GREY, within=45)
        (left, *_, right) = np.flatnonzero(grey.sum(axis=0) > 200)  # the frame, 112 um either side of the middle
        middle = centre(marked(seen, WHITE, within=8))  # the journal has climbed half of its clearance
        assert middle[0] == pytest.approx((left + right) / 2, abs=3)
        radius = (right - left) / 2 / 1.12
        for angle in np.radians(22.5 + 45.0 * np.arange(8)):
            x, y = round(middle[0] + radius * np.cos(angle)), round(middle[1] - radius * np.sin(angle))
            assert grey[y - 3 : y + 4, x - 3 : x + 4].any()

        def cascade(stream: rr.RecordingStream) -> None:
            order = np.arange(-32, 33) / 8
            amplitude = np.zeros((2, len(order)))
            amplitude[1, order == 1.0] = 50.0
            CascadePicture(stream, "w", title="full spectrum").draw(np.array([1000.0, 2000.0]), order, amplitude)

        seen = on_screen(viewer, flat("w", "cascade", CASCADE_BOUNDS), cascade, tmp_path)
        line = marked(seen, BLUE)
        top = np.flatnonzero(line.any(axis=1))[0]
        left, right = np.flatnonzero(line.any(axis=0))[[0, -1]]
        assert np.flatnonzero(line[top]).mean() == pytest.approx(left + (right - left) * 5 / 8, abs=4)  # +1 of -4 .. 4

        every = "".join(chr(c) for block in SHOWN for c in block) + "".join(ALSO - {"\n"})
        words = rr.TextDocument(displayable(every + "∠ 轴"))
        view = rrb.TextDocumentView(origin="words")
        seen = on_screen(viewer, view, lambda stream: stream.log("words", words), tmp_path)  # the viewer lives on
        assert marked(seen, INK, within=60).sum() > 1000
