"""Derivatives of the swept response against central differences of it, and the response of several places at once."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.nameplate import Plane
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, scale_properties, with_bearing
from rotorrig.sims.rotor.model.derivatives import along_bearing, along_disk_mass, along_modulus
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.steady.harmonic_response import columns
from rotorrig.sims.rotor.swept.swept_response import swept_columns, swept_derivatives, swept_response
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.sims.rotor.off_nameplate import CHANGES as OFF

RPM = np.pi / 30
STEP = 1e-4


def ramp(start: float, rate: float, turns: int) -> Timeline:
    """Return the pulses of a constant acceleration [rpm/s] from `start` [rpm]."""
    theta, omega, alpha = 2 * np.pi * np.arange(turns), start * RPM, rate * RPM
    return Timeline((np.sqrt(omega**2 + 2 * alpha * theta) - omega) / alpha)


UP, DOWN = ramp(1600, 30, 900), ramp(3000, -60, 600)


def rows_of(timeline: Timeline, count: int = 120):
    t = np.linspace(timeline.t[6], timeline.t[-7], count)
    return tracked_rows(timeline, t=t, revolutions=8, window="hann")


def with_spring(model: RotorModel, c: float, *, p: float = 0.0, q: float = 0.0) -> RotorModel:
    return with_bearing(model, "spring", np.diag([33.9e3 * (1 + p), 34.6e3]), np.diag([c, c * (1 + q)]))


def changes(model: RotorModel, c: float):
    """Return pairs: the model after a relative change, and its direction."""
    return [
        (lambda p: with_spring(model, c, p=p), along_bearing(model, "spring", K=np.diag([33.9e3, 0]))),
        (lambda p: with_spring(model, c, q=p), along_bearing(model, "spring", C=np.diag([0, c]))),
        (lambda p: scale_properties(model, youngs_modulus=1 + p), along_modulus(model)),
        (lambda p: scale_properties(model, disk_mass=1 + p), along_disk_mass(model)),
    ]


@pytest.fixture(scope="module")
def two_planes(rk4: RigConfig) -> RotorModel:
    planes = (Plane(name="coupling", position="20 mm"),)
    return reduce(assemble(rk4.model_copy(update={"planes": planes})), modes=4)


@pytest.mark.parametrize(("c", "tolerance"), [(15.0, 1e-5), (1.0, 5e-5)], ids=["damped", "light"])
@pytest.mark.parametrize("timeline", [UP, DOWN], ids=["up", "down"])
def test_derivatives_are_the_limit_of_differences(two_planes, timeline, c, tolerance):
    model, rows, places = with_spring(two_planes, c), rows_of(timeline), ["disk", "coupling"]
    changed, directions = zip(*changes(model, c), strict=True)
    got = swept_derivatives(model, rows, unbalance=places, directions=directions)
    np.testing.assert_array_equal(got.z, swept_columns(model, rows, unbalance=places))
    step = STEP * c / 15
    for by, change in zip(got.by, changed, strict=True):
        up, down = (swept_columns(change(p), rows, unbalance=places) for p in (step, -step))
        want = (up - down) / (2 * step)
        error = np.abs(by - want).max(axis=(0, 1)) / np.abs(want).max(axis=(0, 1))  # by place
        assert error.max() < tolerance


@pytest.mark.parametrize("name", OFF)
def test_derivatives_by_what_the_nameplate_has_wrong_are_the_limit_of_differences(adjustable, name):
    changed, direction = OFF[name]
    model, rows, h = changed(adjustable, 0.0), rows_of(UP, 60), 2e-3
    (got,) = swept_derivatives(model, rows, unbalance=["disk"], directions=[direction(model)]).by
    up, down = (swept_columns(changed(adjustable, p), rows, unbalance=["disk"]) for p in (h, -h))
    want = (up - down) / (2 * h)
    # a probe at a node: the shear of the elements on either side differs by the inertia of half of both
    assert np.abs(got - want).max() < (1e-4 if name == "probe position" else 2e-5) * np.abs(want).max()


def test_steady_speed_gives_steady_derivatives(small):
    omega = 210.0
    rows = tracked_rows(Timeline(2 * np.pi / omega * np.arange(300)), t=[4.0], revolutions=8, window="hann")
    model = with_spring(small, 15.0)
    changed, directions = zip(*changes(model, 15.0), strict=True)
    got = swept_derivatives(model, rows, unbalance=["disk"], directions=directions).by
    for by, change in zip(got, changed, strict=True):
        up, down = (columns(change(p), [omega], unbalance=["disk"]) for p in (STEP, -STEP))
        want = (up - down) / (2 * STEP)
        np.testing.assert_allclose(by, want, atol=1e-5 * np.abs(want).max())


def test_derivatives_add_up_where_x_and_y_modes_coincide(small):
    """Along kxx and along kyy are along both, where the modes have no directions of their own."""
    model = with_bearing(small, "spring", np.eye(2) * 34e3, np.eye(2) * 15)
    axes = [np.diag([34e3, 0]), np.diag([0, 34e3]), np.eye(2) * 34e3]
    directions = [along_bearing(model, "spring", K=K) for K in axes]
    x, y, both = swept_derivatives(model, rows_of(UP), unbalance=["disk"], directions=directions).by
    np.testing.assert_allclose(x + y, both, atol=1e-9 * np.abs(both).max())


def test_columns_and_amounts_are_the_response(two_planes):
    t = np.linspace(1.0, 15.0, 20)
    amounts = {"coupling": 2e-6j, "disk": 1e-5 - 3e-6j}
    rows = tracked_rows(UP, t=t, revolutions=4.5, window="rectangular")
    want = swept_columns(two_planes, rows, unbalance=["disk", "coupling"]) @ [1e-5 - 3e-6j, 2e-6j]
    got = swept_response(two_planes, UP, t=t, revolutions=4.5, window="rectangular", unbalance=amounts)
    np.testing.assert_allclose(got, want, atol=1e-12 * np.abs(want).max())


def test_no_direction_and_no_place_give_empty_answers(small):
    rows = rows_of(UP, 7)
    assert swept_derivatives(small, rows, unbalance=["disk"], directions=[]).by.shape == (0, 7, 4, 1)
    assert swept_columns(small, rows, unbalance=[]).shape == (7, 4, 0)
