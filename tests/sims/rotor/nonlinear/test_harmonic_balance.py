"""Harmonic balance where the answer is known: forces against a fine turn, Duffing's rotor
in closed form and in time."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, with_bearing
from rotorrig.sims.rotor.model.loads import unbalance_loads
from rotorrig.sims.rotor.nonlinear.harmonic_balance import forces, slopes
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange, differentiate_forces
from rotorrig.sims.rotor.nonlinear.steady_response import steady_with_law
from tests.sims.rotor import jeffcott
from tests.sims.rotor.nonlinear.test_swept_response import at_disk, cubic, friction, push

M = jeffcott.M
K, C, K3 = 3.5e4, 40.0, 4e10  # N/m, N s/m, N/m^3: a damping ratio of 0.12, so that starting transients are soon gone
OMEGA = 220.0  # rad/s
SHAFT = 2e-6  # of the springs' deflection is the shaft's own, which the closed forms take to be rigid
TURN = 2 * np.pi * np.arange(360) / 360
MOTION = np.array([[2e-5, -3e-5, 1e-4, 4e-5, -2e-5, 9e-5, 1e-5, 3e-6, -4e-6, 2e-6, -2e-6, 1e-6, 3e-6, -1e-6]])


def supported(k: tuple[float, float], c: float = C) -> RotorModel:
    """Jeffcott's rotor, `k` in x and y."""
    return with_bearing(assemble(jeffcott.rig(), max_element=0.1), ["a", "b"], np.diag(k) / 2, np.eye(2) * c / 2)


def moved(u: np.ndarray, omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity (axis, angle) of a motion (part,): mean, then real and imaginary parts of 1X, 2X, 3X."""
    mean, *parts = u.reshape(-1, 2)
    at, rate = np.repeat(mean[:, None], len(TURN), axis=1), np.zeros((2, len(TURN)))
    for n, (re, im) in enumerate(zip(parts[::2], parts[1::2], strict=True), start=1):
        turning = (re + 1j * im)[:, None] * np.exp(1j * n * TURN)
        at, rate = at + turning.real, rate + (1j * n * omega * turning).real
    return at, rate


@pytest.mark.parametrize(
    ("force", "constants", "tolerance"),
    [(cubic, (K3,), 1e-12), (friction, (0.3, 1e-2), 1e-5)],
    ids=["cubic", "friction"],
)
def test_harmonics_of_a_force_are_those_of_a_fine_turn(small, force, constants, tolerance):
    """A cubic's ninth harmonic is the last, so that 32 angles are exact; smooth friction has few beyond."""
    law = at_disk(small, force, *constants)
    (x, y), (vx, vy) = moved(MOTION[0], OMEGA)
    push = np.array([force(*at, law.constants) for at in zip(x, y, vx, vy, strict=True)]).T
    phasors = [2 * np.mean(push * np.exp(-1j * n * TURN), axis=1) for n in (1, 2, 3)]
    want = np.concatenate([push.mean(axis=1), *(part for p in phasors for part in (p.real, p.imag))])
    got = forces([law], np.array([OMEGA]), MOTION)[0]
    np.testing.assert_allclose(got, want, atol=tolerance * np.abs(want).max())


def test_slopes_are_central_differences_of_the_harmonics(small):
    law, omega, h = at_disk(small, friction, 0.3, 1e-2), np.array([OMEGA]), 1e-9
    got = slopes([law], omega, MOTION)[0]
    want = np.stack(
        [
            (forces([law], omega, MOTION + by) - forces([law], omega, MOTION - by))[0] / (2 * h)
            for by in h * np.eye(MOTION.shape[1])
        ],
        axis=1,
    )
    np.testing.assert_allclose(got, want, atol=1e-4 * np.abs(want).max())


def test_a_change_of_one_law_of_two_changes_its_own_force_alone(small):
    """A cubic's force is proportional to its constant: the derivative is the force itself over the constant."""
    laws = (at_disk(small, friction, 0.3, 1e-2), at_disk(small, cubic, K3))
    u = np.repeat(MOTION.reshape(7, 1, 2), 2, axis=1).reshape(1, -1)  # both move as MOTION does
    omega, stiffer = np.array([OMEGA]), replace(laws[1], constants=laws[1].constants * 1.01)
    F = forces(laws, omega, u)
    change = LawChange(laws=(laws[0], stiffer), step=0.01)
    got, rest = differentiate_forces(laws, [change], omega, u, F)
    of_friction, of_cubic = got[0, :, 0].reshape(7, 2, 2).swapaxes(0, 1)
    np.testing.assert_allclose(of_cubic, F.reshape(7, 2, 2)[:, 1], rtol=1e-9)
    assert not of_friction.any()
    assert not rest.any()


def test_duffings_rotor_on_equal_springs_whirls_in_circles_of_the_radius_in_closed_form():
    """(K + k3 R^2 - M Omega^2 + j Omega C) R = U Omega^2: in a circle the spring's force has no overtones at all.

    Solved for U at radii up to the top of the leaning peak, and followed along that backbone from below.
    """
    model = supported((K, K))
    R = np.linspace(5e-5, 6e-4, 12)
    omega = np.sqrt((K + K3 * R**2) / M) - 0.5 * C / M  # half a bandwidth before the backbone, on the upper branch
    U = ((K + K3 * R**2 - M * omega**2) + 1j * omega * C) * R / omega**2
    loads, law = unbalance_loads(model, ["disk"]), at_disk(model, cubic, K3)
    for speed, unbalance, radius in zip(omega, U, R, strict=True):
        rising = np.linspace(100.0, speed, 60)
        z = steady_with_law(model, rising, loads, [unbalance], [law], orders=(1, 2, 3))[-1]
        amplified = M * speed / C  # what a change of stiffness does half a bandwidth from the backbone, at most
        np.testing.assert_allclose(z[:, 0], [radius, -1j * radius], atol=SHAFT * 10 * amplified * radius)
        assert np.abs(z[:, 1:]).max() < 1e-6 * radius


def test_unequal_springs_and_a_constant_pull_give_the_harmonics_of_integration_in_time():
    """With means and overtones up to the third, against the periodic motion of the two equations themselves."""
    k, pull, U = (K, 1.15 * K), (4.0, -2.0), 60e-6
    model = supported(k)
    law = at_disk(model, cubic, K3, static=np.divide(pull, k))
    got = steady_with_law(
        model, np.linspace(120.0, OMEGA, 20), unbalance_loads(model, ["disk"]), [U], [law], orders=(1, 2, 3)
    )

    def motion(t, s):
        by = np.array(cubic(s[0], s[1], s[2], s[3], law.constants))
        load = U * OMEGA**2 * np.array([np.cos(OMEGA * t), np.sin(OMEGA * t)])
        return np.concatenate([s[2:], (load + pull + by - C * s[2:] - np.array(k) * s[:2]) / M])

    turns = 60  # exp(-C / (2 M) 60 turns) is 2e-19
    t = (turns + np.arange(256) / 256) * 2 * np.pi / OMEGA
    x = solve_ivp(motion, (0, t[-1]), [*np.divide(pull, k), 0, 0], "DOP853", t_eval=t, rtol=1e-9, atol=1e-13).y[:2]
    for i, n in enumerate((1, 2, 3)):
        want = 2 * np.mean(x * np.exp(-1j * n * OMEGA * t), axis=1)
        np.testing.assert_allclose(got[-1, :, i], want, atol=2e-4 * np.abs(x).max(), err_msg=f"{n}X")


def test_a_constant_push_moves_the_mean_by_the_static_flexibility():
    model = supported((K, 1.15 * K))
    law = at_disk(model, push, 3.0, -1.0)
    (z,) = steady_with_law(model, [OMEGA], unbalance_loads(model, ["disk"]), [0.0], [law], orders=(0, 1))
    np.testing.assert_allclose(z[:, 0], [3.0 / K, -1.0 / (1.15 * K)], rtol=SHAFT)
    assert np.abs(z[:, 1]).max() < 1e-12
