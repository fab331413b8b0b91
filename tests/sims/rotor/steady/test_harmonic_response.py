"""The harmonic response against the chapter's real form and against the equation itself."""

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import matrices
from rotorrig.sims.rotor.steady.harmonic_response import (
    SPEEDS_AT_ONCE,
    dynamic_stiffness,
    probe_response,
    steady_response,
)


def test_phasors_solve_the_chapters_real_equation_11(small):
    omega = 220.0
    M, C, G, K = matrices(small)
    D, S = omega * (C + omega * G), K - omega**2 * M
    disk = small.disk("disk").rows
    force = omega**2 * 1e-5 * np.concatenate([disk[0], disk[1]])  # F_C along x, F_S along y
    cosine, sine = np.split(np.linalg.solve(np.block([[S, D], [-D, S]]), force), 2)  # printed with Omega C swapped
    q = steady_response(small, omega, unbalance={"disk": 1e-5})[0]
    np.testing.assert_allclose(q, cosine - 1j * sine, atol=1e-10 * abs(q).max())


def test_a_long_grid_is_solved_as_speed_by_speed(small):
    omega = np.linspace(30, 400, 2 * SPEEDS_AT_ONCE + 7)
    whole = probe_response(small, omega, unbalance={"disk": 1e-5})
    assert whole.shape == (len(omega), 4)
    for i in (0, SPEEDS_AT_ONCE, len(omega) - 1):
        np.testing.assert_allclose(whole[i], probe_response(small, omega[i], unbalance={"disk": 1e-5})[0], rtol=1e-12)


def test_unbalances_of_several_disks_add(small):
    other = {"disk": 1e-5 + 2e-5j}
    np.testing.assert_allclose(
        probe_response(small, 200.0, unbalance=other),
        probe_response(small, 200.0, unbalance={"disk": 1e-5})
        + probe_response(small, 200.0, unbalance={"disk": 2e-5j}),
    )


def test_acceleration_adds_a_force_a_quarter_of_a_turn_behind(small):
    steady = probe_response(small, 200.0, unbalance={"disk": 1e-5})
    moving = probe_response(small, 200.0, unbalance={"disk": 1e-5}, alpha=400.0)
    np.testing.assert_allclose(moving, steady * (1 - 0.01j))


def test_order_minus_one_of_an_isotropic_rotor_is_its_backward_whirl(small):
    """Turning the other way at the same shaft speed is the forward whirl with the gyroscopic sign turned."""
    Z = dynamic_stiffness(small, 300.0, order=-1.0)[0]
    M, C, G, K = matrices(small)
    np.testing.assert_allclose(Z, K - 300.0**2 * M - 300j * (C + 300.0 * G))
    twice = dynamic_stiffness(small, 300.0, order=2.0)[0]
    np.testing.assert_allclose(twice, K - 600.0**2 * M + 600j * (C + 300.0 * G))  # the shaft still turns at 300


def test_no_unbalance_is_no_response(small):
    assert probe_response(small, [100.0, 200.0], unbalance={}) == pytest.approx(np.zeros((2, 4)))
