"""Forward and backward whirl of orbits drawn by hand."""

from typing import Any

import numpy as np
import pytest

from rotorrig.processing.probe_planes import measured_planes, planes, whirl
from rotorrig.rig.config.description import RigConfig, from_si

ANGLES = {"square": (0.0, 90.0), "tilted": (45.0, 135.0), "oblique": (20.0, 80.0)}


def rig_with(rk4: RigConfig, degrees: tuple[float, float], rotation: str) -> RigConfig:
    table: dict[str, Any] = rk4.model_dump(mode="json")
    table["probes"] = table["probes"][:2]
    for probe, angle in zip(table["probes"], degrees, strict=True):
        probe["angle"] = np.radians(angle)
    table["rotation"] = rotation
    return from_si(table, where="a test")


def seen(rig: RigConfig, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the 1X vectors of both probes from one turn of an orbit, by the definition of the vector."""
    turn = np.exp(-2j * np.pi * np.arange(len(x)) / len(x))
    read = [x * np.cos(p.angle) + y * np.sin(p.angle) for p in rig.probes]
    return np.array([2 * np.mean(r * turn) for r in read])


@pytest.mark.parametrize("degrees", ANGLES.values(), ids=ANGLES)
@pytest.mark.parametrize(("rotation", "way"), [("x-to-y", 1), ("y-to-x", -1)])
def test_circles_are_all_forward_or_all_backward(
    rk4: RigConfig, degrees: tuple[float, float], rotation: str, way: int
) -> None:
    rig = rig_with(rk4, degrees, rotation)
    (plane,) = planes(rig)
    angle = 2 * np.pi * np.arange(64) / 64 + 0.3
    x_to_y = whirl(plane, seen(rig, 3 * np.cos(angle), 3 * np.sin(angle)), rotation=rotation)
    y_to_x = whirl(plane, seen(rig, 3 * np.cos(angle), -3 * np.sin(angle)), rotation=rotation)
    np.testing.assert_allclose(np.abs(x_to_y), [3, 0] if way > 0 else [0, 3], atol=1e-12)
    np.testing.assert_allclose(np.abs(y_to_x), [0, 3] if way > 0 else [3, 0], atol=1e-12)


def test_a_straight_line_is_half_of_each(rk4: RigConfig) -> None:
    rig = rig_with(rk4, ANGLES["square"], "x-to-y")
    angle = 2 * np.pi * np.arange(64) / 64
    z = seen(rig, 4 * np.cos(angle), 4 * np.cos(angle))
    assert np.abs(whirl(planes(rig)[0], z, rotation="x-to-y")) == pytest.approx([4 / np.sqrt(2)] * 2)


def test_probes_of_other_planes_or_along_one_line_make_no_plane(rk4: RigConfig) -> None:
    assert list(measured_planes(rk4, ["1x", "2y"])) == []
    assert [places for _, places in measured_planes(rk4, ["2y", "1x", "2x", "1y"])] == [[1, 3], [2, 0]]
    assert planes(rig_with(rk4, (10.0, 190.0), "x-to-y")) == ()
