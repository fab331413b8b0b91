"""Where the mean position goes, and the circle it can move in."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.centreline_paths import (
    CentrelinePath,
    ClearanceCircle,
    centreline_paths,
    clearance_circle,
    half_width,
    is_seen_in,
)
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig


def test_a_shaft_that_rises_with_the_speed_is_seen_to_rise(response: OrderTrackedResponse) -> None:
    """20 µm in y from the slowest to the fastest row, seen by probes at 0 and 90 degrees."""
    z = response.z.copy()
    lift = 20e-6 * (response.omega - response.omega.min()) / np.ptp(response.omega)
    z[:, :, 0] = lift[:, None] * np.sin([probe.angle for probe in response.rig.probes])
    up, *_ = centreline_paths(dataclasses.replace(response, z=z))
    assert np.abs(up.x).max() < 1e-9
    began = 20 * 4.5 * (3120 / 364) / 3360  # the first eight rows' mean is where it is counted from, 240 rpm is below
    assert np.ptp(up.y) == pytest.approx(20 * 3120 / 3360)  # the run goes from 480 to 3600 rpm
    assert up.y.min() == pytest.approx(-began, rel=0.3)


def with_clearances(rig: RigConfig, *clearances: float | None, gravity: str = "-y") -> RigConfig:
    bearings = tuple(
        bearing.model_copy(update={"clearance": clearance})
        for bearing, clearance in zip(rig.bearings, clearances, strict=True)
    )
    return rig.model_copy(update={"bearings": bearings, "gravity": gravity})


def test_the_circle_is_the_nearest_bearings_and_stands_on_the_beginning(rig: RigConfig) -> None:
    told = with_clearances(rig, 100e-6, 120e-6, 60e-6)  # left A and B at 65 and 80 mm, the spring at 481 mm
    left, right = clearance_circle(told, 0.2), clearance_circle(told, 0.4)
    assert left is not None and right is not None
    assert (left.bearing, left.radius, left.x, left.y) == ("left B", pytest.approx(60), 0.0, pytest.approx(60))
    assert (right.bearing, right.radius) == ("spring", pytest.approx(30))


def test_the_circle_follows_gravity(rig: RigConfig) -> None:
    circle = clearance_circle(with_clearances(rig, 1e-4, 1e-4, 1e-4, gravity="-x"), 0.4)
    assert circle is not None
    assert (circle.x, circle.y) == (pytest.approx(50), 0.0)


def test_there_is_no_circle_where_the_clearance_is_not_known(rig: RigConfig) -> None:
    assert clearance_circle(with_clearances(rig, 1e-4, 1e-4, None), 0.4) is None


def test_axes_hold_the_circle_the_path_is_seen_in_else_the_path() -> None:
    x = np.linspace(0.0, 30.0, 50)
    path = CentrelinePath(plane="here", position=0.1, run="up", direction=1, rpm=100 * x, x=x, y=0 * x)
    seen = ClearanceCircle(bearing="left", radius=100.0, x=0.0, y=100.0)
    assert is_seen_in([path], seen)
    assert half_width([path], seen) == 150.0  # 112, rounded up
    wide = dataclasses.replace(seen, radius=2000.0, y=2000.0)
    assert not is_seen_in([path], wide)
    assert half_width([path], wide) == half_width([path], None) == 40.0  # 31.5, rounded up
    still = dataclasses.replace(path, x=x / 100)
    assert half_width([still], None) == 5.0, "noise is not blown up to the size of the picture"
