"""The choice of what is passed, and the steady response put together from its parts."""

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import RotorModel, with_bearing
from rotorrig.sims.rotor.model.loads import unbalance_pattern
from rotorrig.sims.rotor.modes.modes import whirl_modes
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from rotorrig.sims.rotor.swept import passed_modes
from rotorrig.sims.rotor.swept.timeline import SpeedRange

U = {"disk": 1e-5}
SPEEDS = SpeedRange(50.0, 377.0)


def passed(model: RotorModel) -> passed_modes.PassedModes:
    return passed_modes.fit_passed_modes(
        passed_modes.solve_spectra(model, SPEEDS), unbalance_pattern(model, U)[:, None]
    )


def at(omega, coefficients):
    return np.tensordot(SPEEDS.powers(omega, len(coefficients)), coefficients, 1)


def test_the_passed_modes_are_the_rotors_own(small):
    modes = passed(small)
    for omega in (60.0, 250.0):
        got = np.sort(np.linalg.eigvals(at(np.array(omega), modes.L)).imag)
        want = [mode.frequency for mode in whirl_modes(small, omega, count=2)]
        np.testing.assert_allclose(got, want, rtol=1e-6)


def test_poles_near_the_speeds_are_passed_and_the_widest_gap_bounds_them():
    distance = np.array([4.0, 5.0, 280.0, 285.0, 300.0, 900.0])
    assert passed_modes._count_passed(distance, far=100.0) == 2
    assert passed_modes._count_passed(distance, far=290.0) == 5
    assert passed_modes._count_passed(distance, far=1e4) == 5  # all there are but one


def test_many_modes_are_passed_only_where_few_would_part_what_is_close_together():
    pedestal = np.array([1.4, 1.4, 1.4, 2.6, 21, 38, 65, 66, 130, 133, 233, 235, 557, 582])  # on an RK4
    assert passed_modes._count_passed(pedestal, far=30.0) == 8  # before 2.0 times; 2.4 times after 12
    crowded = np.array([2.0, 15, 29, 33, 38, 44, 51, 60, 70, 82, 95, 200, 210])  # no gap of the first eight is clear
    assert passed_modes._count_passed(crowded, far=30.0) == 11


@pytest.mark.parametrize("c", [1.0, 15.0])
def test_passed_and_others_together_are_the_steady_response(small, c):
    model = with_bearing(small, "spring", np.diag([33.9e3, 34.6e3]), np.eye(2) * c)
    modes = passed(model)
    omega = np.linspace(50, 377, 41)
    squared = omega[:, None, None] ** 2
    operator = at(omega, modes.L) - 1j * omega[:, None, None] * np.eye(2)
    a = np.linalg.solve(operator, -at(omega, modes.g) * squared)
    got = (at(omega, modes.shape).swapaxes(1, 2) @ a + at(omega, modes.others) * squared)[..., 0]
    want = probe_response(model, omega, unbalance=U)
    assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()
