"""Force laws in a sweep against integration of the vibration in time, and where the answer is linear.

What is left of the error is the describing function's: the force's higher harmonics do not act back. A cubic spring of
a tenth of the rotor's stiffness at the peak has 0.6 % of that, where the response falls off its branch.
"""

import math

import numpy as np
import pytest
from numba import njit

from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.rotor.model.assembly import Added, assemble, matrices, with_added
from rotorrig.sims.rotor.model.loads import unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.steady_response import steady_with_law
from rotorrig.sims.rotor.nonlinear.swept_response import swept_with_law
from rotorrig.sims.rotor.steady.harmonic_response import load_columns
from rotorrig.sims.rotor.swept.swept_response import swept_columns
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.sims.rotor import jeffcott
from tests.sims.rotor.collocation import RPM, Ramp

U = 15e-6 * np.exp(0.6j)
UP, DOWN = (1700, 30, 26.0), (2450, -60, 11.0)  # rpm, rpm/s, s


@njit(cache=True)
def cubic(x, y, vx, vy, constants):
    k = -constants[0] * (x * x + y * y)
    return k * x, k * y


@njit(cache=True)
def friction(x, y, vx, vy, constants):
    part = -constants[0] / math.sqrt(vx * vx + vy * vy + constants[1] ** 2)
    return part * vx, part * vy


@njit(cache=True)
def stop(x, y, vx, vy, constants):
    r = math.sqrt(x * x + y * y)
    k = -constants[0] * max(r - constants[1], 0.0) / max(r, 1e-12)
    return k * x, k * y


@njit(cache=True)
def spring(x, y, vx, vy, constants):
    return -constants[0] * x - constants[1] * vx, -constants[0] * y - constants[1] * vy


@njit(cache=True)
def push(x, y, vx, vy, constants):
    return constants[0], constants[1]


@pytest.fixture(scope="module")
def model():
    return reduce(assemble(jeffcott.rig(), max_element=0.1))


def at_disk(model, force, *constants: float, static=(0.0, 0.0)) -> ForceLaw:
    return ForceLaw(
        rows=model.disk("disk").rows[:2], force=force, constants=np.array(constants), static=np.array(static)
    )


def laid_out(start: float, rate: float, seconds: float):
    ramp = Ramp(start * RPM, rate * RPM, seconds)
    return ramp, tracked_rows(ramp.timeline, t=ramp.rows, revolutions=10, window="hann")


def error(got: np.ndarray, want: np.ndarray) -> float:
    return float(np.abs(got - want).max() / np.abs(want).max())


@pytest.mark.parametrize(
    ("force", "constants", "sweep", "tolerance"),
    [
        (cubic, (5e10,), DOWN, 2e-4),
        (friction, (0.3, 1e-3), DOWN, 1e-3),
    ],
    ids=["cubic", "friction"],
)
def test_a_law_is_that_of_integration_in_time(model, force, constants, sweep, tolerance):
    ramp, rows = laid_out(*sweep)
    law = at_disk(model, force, *constants)
    want = jeffcott.tracked(ramp, U, turns=10, force=lambda *motion: force(*motion, law.constants))[..., 0]
    loads = unbalance_loads(model, ["disk"])
    got = swept_with_law(model, rows, loads, [U], [law])[..., 0]
    assert error(got, want) < tolerance
    assert error(swept_columns(model, rows, loads=loads) @ [U], want) > 0.1  # what is being modelled


@pytest.mark.campaign
def test_a_place_that_rests_on_a_stop_is_pushed_off_it_and_shakes_twice_a_turn(model):
    """The mean and the second harmonic, against integration with the same offset."""
    ramp, rows = laid_out(*DOWN)
    static = (9e-5, -2e-5)
    law = at_disk(model, stop, 3e3, 8e-5, static=static)
    got = swept_with_law(model, rows, unbalance_loads(model, ["disk"]), [U], [law], orders=(0, 1, 2))
    want = jeffcott.tracked(
        ramp, U, turns=10, orders=(0, 1, 2), static=static, force=lambda *motion: stop(*motion, law.constants)
    )
    want[..., 0] -= static
    for i, tolerance in ((0, 2e-2), (1, 5e-3), (2, 5e-2)):
        assert error(got[..., i], want[..., i]) < tolerance


def test_a_linear_law_is_a_spring_and_a_damper(model):
    k, c = 2e3, 4.0
    rows_at = model.disk("disk").rows[:2]
    stiffer = with_added(model, Added(K=k * rows_at.T @ rows_at, C=c * rows_at.T @ rows_at))
    _, rows = laid_out(*UP)
    loads, law = unbalance_loads(model, ["disk"]), at_disk(model, spring, k, c)
    assert (
        error(swept_with_law(model, rows, loads, [U], [law])[..., 0], swept_columns(stiffer, rows, loads=loads) @ [U])
        < 2e-3
    )


def test_a_linear_law_is_a_spring_and_a_damper_at_steady_speeds_too(small):
    k, c, omega, loads = 2e3, 4.0, np.linspace(100, 300, 20), unbalance_loads(small, ["disk"])
    law = at_disk(small, spring, k, c)
    stiffer = with_added(small, Added(K=k * law.rows.T @ law.rows, C=c * law.rows.T @ law.rows))
    got = steady_with_law(small, omega, loads, [U], [law])[..., 0]
    np.testing.assert_allclose(got, (load_columns(stiffer, omega, loads) @ [U]), rtol=1e-5)


def test_several_laws_at_one_place_are_one(model):
    _, rows = laid_out(*DOWN)
    loads = unbalance_loads(model, ["disk"])
    one = swept_with_law(model, rows, loads, [U], [at_disk(model, cubic, 1e10)])
    two = swept_with_law(model, rows, loads, [U], [at_disk(model, cubic, 4e9), at_disk(model, cubic, 6e9)])
    np.testing.assert_allclose(two, one, atol=1e-5 * np.abs(one).max())


def test_a_steady_mean_force_shifts_the_mean_by_the_flexibility(small):
    law = at_disk(small, push, 3.0, -1.0)
    at = law.rows
    got = steady_with_law(small, [150.0], unbalance_loads(small, ["disk"]), [U], [law], orders=(0, 2))
    want = small.probes @ np.linalg.solve(matrices(small).K, at.T @ [3.0, -1.0])
    np.testing.assert_allclose(got[0, :, 0], want, rtol=1e-9)
    np.testing.assert_allclose(got[0, :, 1], 0, atol=1e-15)


def test_a_hardening_spring_keeps_its_branch_on_the_way_up_and_on_the_way_down(small):
    """Between the folds both are steady states; the upper one is met from below."""
    law, loads = at_disk(small, cubic, 5e10), unbalance_loads(small, ["disk"])
    omega = np.linspace(200, 300, 201)
    up = np.abs(steady_with_law(small, omega, loads, [U], [law])[:, 0, 0])
    down = np.abs(steady_with_law(small, omega[::-1], loads, [U], [law])[::-1, 0, 0])
    apart = up > 1.5 * down
    assert apart.any()
    np.testing.assert_allclose(up[~apart][:20], down[~apart][:20], rtol=1e-5)


def test_a_law_that_is_no_numba_function_is_refused(model):
    with pytest.raises(ConfigError, match="want a function decorated with numba"):
        at_disk(model, cubic.py_func, 1.0)


def test_a_motion_beyond_bounds_is_an_error_of_the_law_in_one_sentence(model):
    """A fit may ask for one on its way, and goes elsewhere on a DataError."""
    _, rows = laid_out(*DOWN)
    with np.errstate(all="ignore"), pytest.raises(DataError, match="law: its force at 3X is beyond bounds"):
        swept_with_law(
            model, rows, unbalance_loads(model, {"disk": 1.0}), [1e200], [at_disk(model, cubic, 5e10)], orders=(3,)
        )
