"""The small matrix routines of the integrator, and its steps where the answer is known."""

import numpy as np
import pytest
from scipy import linalg

from rotorrig.sims.rotor.swept import time_stepping


@pytest.mark.parametrize("size", [1, 2, 5])
@pytest.mark.parametrize("scale", [1e-6, 0.3, 30.0])
def test_exponential_and_inverse_are_those_of_scipy(rng, size, scale):
    A = scale * (rng.normal(size=(size, size)) + 1j * rng.normal(size=(size, size)))
    A -= 1j * scale * np.eye(size)
    got, *work = np.empty((5, size, size), dtype=complex)
    time_stepping.exponential(A, 0.7, got, np.array(work))
    want = linalg.expm(0.7 * A)
    np.testing.assert_allclose(got, want, atol=1e-10 * np.abs(want).max())
    time_stepping.invert(A, got, work[0])
    np.testing.assert_allclose(got @ A, np.eye(size), atol=1e-10)


def test_the_exponential_of_a_double_pole_without_two_vectors_is_right():
    got, work = np.empty((2, 2), dtype=complex), np.empty((4, 2, 2), dtype=complex)
    time_stepping.exponential(np.array([[1j, 3.0], [0, 1j]]), 0.5, got, work)
    np.testing.assert_allclose(got, np.exp(0.5j) * np.array([[1, 1.5], [0, 1]]), rtol=1e-14)


def test_a_constant_system_is_stepped_exactly():
    """a' = L a + p0 + p1 t + p2 t^2 with one mode, two forces: the solution by variation of constants."""
    L, p = -0.4 + 3j, np.array([[1.0, 0.5j, -0.2], [0.3, -1.0, 0.1j]]).T
    t = np.array([0, 0.5, 0.75])
    h = np.diff(t)
    at, mid = (np.polynomial.polynomial.polyval(times, p).T[:, None] + 0j for times in (t, t[:-1] + h / 2))
    start = np.array([[0.3 + 0j, -0.2j]])
    operator = np.full((3, 1, 1), L)
    a, rate = time_stepping.step_modes(
        operator, time_stepping.propagators(operator[1:], h), np.ones((2, 2)) + 0j, at, mid, start
    )
    c2 = -p[2] / L
    c1 = (2 * c2 - p[1]) / L
    c0 = (c1 - p[0]) / L
    t = t[:, None]
    free = np.exp(L * t) * (start - c0)
    np.testing.assert_allclose(a[:, 0], c0 + c1 * t + c2 * t**2 + free, rtol=1e-10)
    np.testing.assert_allclose(rate[:, 0], c1 + 2 * c2 * t + L * free, rtol=1e-10)


def test_a_turning_frame_changes_nothing_but_the_frame():
    """Forces and answers are in the frame of their instant: with w = 2, a = b e^{-jwt}, b' = L b + f e^{jwt}."""
    L, w, h = np.full((1, 1, 1), -0.3 + 1j), 2.0, np.array([0.5])
    phase = np.exp(1j * w * np.array([0, 0.25, 0.5]))
    f = np.array([1.0, 2.0, 0.5]) + 0j
    steps, start = time_stepping.propagators(L, h), np.array([[0.7 + 0j]])
    still = (f * phase).reshape(3, 1, 1)
    operator = np.concatenate([L, L])
    want = (
        time_stepping.step_modes(operator, steps, np.ones((1, 2)) + 0j, still[::2], still[1:2], start)[0][1] / phase[2]
    )
    turned = f.reshape(3, 1, 1)
    got = time_stepping.step_modes(operator, steps, phase[None, 1:], turned[::2], turned[1:2], start)[0][1]
    np.testing.assert_allclose(got, want, rtol=1e-12)


def test_a_push_is_the_change_times_the_motion(rng):
    """Two directions, two modes, three loads, a change that is straight in x: its mean is its value halfway."""
    coefficients = rng.normal(size=(2, 2, 2, 2, 2, 2))  # (L or T, power, direction, mode, mode, re or im)
    x, alpha = np.array([-0.5, 0.1, 0.7]), np.full(3, 0.4)
    power = np.vander(x, 2, increasing=True)
    a, a_mid = rng.normal(size=(3, 2, 3)) + 0j, rng.normal(size=(2, 2, 3)) + 0j
    force, mid = np.ones((3, 2, 6), dtype=complex), np.ones((2, 2, 6), dtype=complex)
    still, turning = coefficients.reshape(2, 2, -1)
    time_stepping.add_operator_change(still, turning, power, alpha, a, a_mid, force, mid)
    L, T = coefficients[..., 0] + 1j * coefficients[..., 1]

    def pushed(x, a):
        change = np.einsum("tq,qdij->tdij", np.vander(x, 2, increasing=True), L - 0.4 * T)
        return 1 + np.einsum("tdij,tjl->tidl", change, a).reshape(len(x), 2, 6)

    np.testing.assert_allclose(force, pushed(x, a), rtol=1e-12)
    np.testing.assert_allclose(mid, pushed((x[1:] + x[:-1]) / 2, a_mid), rtol=1e-12)
