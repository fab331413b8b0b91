"""Polar plots: where vectors, speeds and labels stand, read back from what was logged."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from rotorrig.app.viewer.plots.polar import PolarPicture, speed_marks

MIDDLE = (50.0, 50.0)  # of the picture, whose outer circle has a radius of 50 and whose y points down
Drawn = Callable[..., np.ndarray]


@pytest.fixture
def drawn(tmp_path: Path) -> Drawn:
    """Draw one vector [µm, ° of lag] under an outer circle of 100 µm and return its place from the middle, y up."""

    def draw(amplitude: float, lag: float, *, probe: float = 0.0, rotation: str = "x-to-y") -> np.ndarray:
        stream = rr.RecordingStream("polar", recording_id=f"{amplitude}-{lag}-{probe}-{rotation}")
        stream.save(str(tmp_path / "polar.rrd"))
        picture = PolarPicture(stream, "p", title="", probe_angle=np.radians(probe), rotation=rotation, static=True)
        picture.draw([("full", np.array([80e-6 + 0j, 90e-6 + 0j]), (1, 2, 3))])
        stream.set_time("step", sequence=0)
        picture.dots("one", np.array([amplitude * 1e-6 * np.exp(-1j * np.radians(lag))]), (4, 5, 6))
        stream.disconnect()
        x, y = places(tmp_path / "polar.rrd", "/p/one")[0]
        return np.array([x - MIDDLE[0], MIDDLE[1] - y])

    return draw


def places(rrd: Path, entity: str) -> np.ndarray:
    """Return the positions of the points of an entity, (point, 2)."""
    for chunk in RrdReader(str(rrd)).stream():
        if str(chunk.entity_path) == entity:
            table = chunk.to_record_batch()
            column = next(c for c in table.schema.names if c.endswith("positions"))
            return np.array(table.column(column)[0].as_py())
    raise AssertionError(f"{entity} was not logged")


def test_lag_runs_against_rotation_from_the_probe(drawn: Drawn) -> None:
    assert drawn(50, 0) == pytest.approx([25, 0], abs=1e-4)
    assert drawn(50, 90) == pytest.approx([0, -25], abs=1e-4)  # clockwise, the rotor turns counterclockwise
    assert drawn(50, 90, rotation="y-to-x") == pytest.approx([0, 25], abs=1e-4)
    assert drawn(50, 0, probe=90) == pytest.approx([0, 25], abs=1e-4)
    assert drawn(50, 30, probe=90) == pytest.approx([12.5, 25 * np.sqrt(0.75)], abs=1e-4)


def test_two_probes_that_see_a_circular_orbit_show_one_picture(drawn: Drawn) -> None:
    """A circle from x to y lags by 90 degrees more at y: x = r cos(theta - 20 deg), y = r sin(theta - 20 deg)."""
    assert drawn(40, 20) == pytest.approx(drawn(40, 110, probe=90), abs=1e-4)
    assert drawn(40, 20, rotation="y-to-x") == pytest.approx(drawn(40, 110, probe=-90, rotation="y-to-x"), abs=1e-4)


def test_speeds_are_named_at_whole_hundreds_and_not_on_top_of_each_other() -> None:
    rpm = np.linspace(950.0, 1450.0, 51)
    path = np.linspace(0.0, 50.0, 51) + 0j
    assert [round(rpm[i]) for i in speed_marks(rpm, path, apart=5.0)] == [1000, 1100, 1200, 1300, 1400]
    assert [round(rpm[i]) for i in speed_marks(rpm, path, apart=15.0)] == [1000, 1200, 1400]
    assert speed_marks(np.full(3, np.nan), path[:3], apart=1.0) == []
