"""The small matrix routines of the integrator, and the choice of what is passed."""

import numpy as np
import pytest
from scipy import linalg

from rotorrig.sims.rotor import passage
from rotorrig.sims.rotor.assembly import with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.modes import whirl_modes

U = {"disk": 1e-5}


@pytest.mark.parametrize("size", [1, 2, 5])
@pytest.mark.parametrize("scale", [1e-6, 0.3, 30.0])
def test_exponential_and_inverse_are_those_of_scipy(rng, size, scale):
    A = scale * (rng.normal(size=(size, size)) + 1j * rng.normal(size=(size, size)))
    A -= 1j * scale * np.eye(size)
    got, work, power = np.empty((3, size, size), dtype=complex)
    passage._exponential(A, 0.7, got, work, power)
    want = linalg.expm(0.7 * A)
    np.testing.assert_allclose(got, want, atol=1e-10 * np.abs(want).max())
    passage._invert(A, got, work)
    np.testing.assert_allclose(got @ A, np.eye(size), atol=1e-10)


def test_a_constant_system_is_stepped_exactly():
    """a' = L a + p0 + p1 t + p2 t^2 with one mode: the solution by variation of constants."""
    L, p = -0.4 + 3j, np.array([1.0, 0.5j, -0.2])
    h = np.array([0.5, 0.25])
    t = np.array([0, 0.5, 0.75])
    at = np.stack([t[:-1], t[:-1] + h / 2, t[1:]], axis=1)
    forces = np.polynomial.polynomial.polyval(at, p)[..., None].astype(complex)
    a = passage._steps(np.full((2, 1, 1), L), h, forces, np.ones(2, dtype=complex), np.array([0.3 + 0j]))[:, 0]
    c2 = -p[2] / L
    c1 = (2 * c2 - p[1]) / L
    c0 = (c1 - p[0]) / L
    np.testing.assert_allclose(a, c0 + c1 * t + c2 * t**2 + np.exp(L * t) * (0.3 - c0), rtol=1e-10)


def test_the_passed_modes_are_the_rotors_own(small):
    modes = passage.passage(small, slowest=50.0, fastest=377.0, unbalance=U)
    for omega in (60.0, 250.0):
        power = modes.powers(np.array(omega))
        got = np.sort(np.linalg.eigvals(np.tensordot(power, modes.L, 1)).imag)
        want = [mode.frequency for mode in whirl_modes(small, omega, count=2)]
        np.testing.assert_allclose(got, want, rtol=1e-6)


def test_poles_near_the_speeds_are_passed_and_the_widest_gap_bounds_them():
    distance = np.array([4.0, 5.0, 280.0, 285.0, 300.0, 900.0])
    assert passage._passed(distance, far=100.0) == 2
    assert passage._passed(distance, far=290.0) == 5
    assert passage._passed(distance, far=1e4) == 5  # all there are but one


def test_passed_and_others_together_are_the_steady_response(small):
    light = with_bearing(small, "spring", np.diag([33.9e3, 34.6e3]), np.eye(2) * 1.0)
    modes = passage.passage(light, slowest=50.0, fastest=377.0, unbalance=U)
    omega = np.linspace(50, 377, 41)
    power = modes.powers(omega)
    operator = passage._operator(modes, omega, np.zeros(41))
    a = np.linalg.solve(operator, -passage._force(modes, omega, np.zeros(41))[..., None])[..., 0]
    got = np.einsum("tm,ti,imp->tp", a, power, modes.shape) + omega[:, None] ** 2 * (power @ modes.others)
    want = probe_response(light, omega, unbalance=U)
    assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()
