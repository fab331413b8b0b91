"""Whitening: residuals drawn from the covariance come out with unit variance, masked vectors play no part."""

from dataclasses import replace

import numpy as np

from rotorrig.identify.measurement import measure, trial_unbalance
from rotorrig.processing.response import OrderTrackedResponse, Run


def test_noise_of_the_stated_covariance_whitens_to_one_sigma(
    blind_response: OrderTrackedResponse, rng: np.random.Generator
) -> None:
    exact = blind_response.rig.model_copy(
        update={"prior": blind_response.rig.prior.model_copy(update={"probe_linearity": 0.0})}
    )
    response = replace(blind_response, rig=exact)
    measured = measure(response)
    order = response.orders.index(1.0)
    factor = np.linalg.cholesky(response.covariance[measured.rows, order])
    pairs = np.einsum("rij,rjk->rik", factor, rng.standard_normal((*factor.shape[:2], 200)))
    noise = pairs[:, 0::2] + 1j * pairs[:, 1::2]
    full = np.concatenate([noise, np.zeros_like(noise[:1])])
    sigmas = np.stack([measured.sigmas(full[..., k]) for k in range(200)])[:, :-1]
    assert abs(sigmas.std() - 1) < 0.01
    neighbours = (sigmas[..., 0] * sigmas[..., 2]).mean()  # two probes, correlated in the data
    assert abs(neighbours) < 0.02


def test_drawn_noise_is_that_of_the_covariance(blind_response: OrderTrackedResponse, rng: np.random.Generator) -> None:
    usable = blind_response.usable.copy()
    usable[:, 1] = False
    measured = measure(replace(blind_response, usable=usable))
    sigmas = np.stack([measured.sigmas(measured.noise(rng)) for _ in range(50)])[:, :-1]
    assert abs(sigmas[..., [0, 1, 4, 5, 6, 7]].std() - 1) < 0.02
    assert (measured.noise(rng)[:-1, 1] == 0).all()


def test_a_masked_vector_has_no_weight(blind_response: OrderTrackedResponse) -> None:
    usable = blind_response.usable.copy()
    usable[10, 1] = False
    measured = measure(replace(blind_response, usable=usable))
    row = int(np.flatnonzero(measured.rows == 10)[0]) if 10 in measured.rows else None
    off = np.zeros_like(measured.z)
    assert row is not None
    off[row, 1] = 1.0
    assert np.abs(measured.sigmas(off)).max() == 0
    assert measured.size == 2 * (measured.usable.size - 1)


def test_the_scale_factors_linearity_widens_large_readings_only(blind_response: OrderTrackedResponse) -> None:
    measured = measure(blind_response)
    order = blind_response.orders.index(1.0)
    noise = np.einsum("rii->ri", blind_response.covariance[measured.rows, order])[:, :2].mean(axis=1)
    amplitude = np.abs(blind_response.compensated()[measured.rows, 0])
    share = blind_response.rig.prior.probe_linearity * amplitude
    np.testing.assert_allclose(measured.sigma[:-1, 0] ** 2, noise + share**2, rtol=1e-9)


def test_at_2x_the_share_is_of_the_synchronous_motion(blind_response: OrderTrackedResponse) -> None:
    measured = measure(blind_response, order=2.0)
    second = blind_response.orders.index(2.0)
    noise = np.einsum("rii->ri", blind_response.covariance[measured.rows, second])[:, :2].mean(axis=1)
    share = blind_response.rig.prior.probe_linearity * np.abs(blind_response.compensated(1.0)[measured.rows, 0])
    np.testing.assert_allclose(measured.sigma[:-1, 0] ** 2, noise + share**2, rtol=1e-9)


MASS = {"disk": 12e-6j}


def test_each_row_has_the_mass_of_its_run_and_the_slow_roll_that_of_its_own(healthy: OrderTrackedResponse) -> None:
    up, down = (replace(run, trial_unbalance={}) for run in healthy.runs)
    rows = np.array([0, len(healthy.omega) - 1], dtype=np.intp)
    assert [healthy.runs[i].name for i in healthy.run[rows]] == ["up", "down"]
    roll = Run(name="slow roll", direction=0, trial_unbalance=MASS)
    later = replace(healthy, runs=(up, replace(down, trial_unbalance=MASS)))
    np.testing.assert_array_equal(trial_unbalance(later, rows)["disk"], [0, 12e-6j, 0])
    always = replace(healthy, runs=(up, down, roll))
    np.testing.assert_array_equal(trial_unbalance(always, rows)["disk"], [0, 0, 12e-6j])


def test_a_rig_without_trial_masses_has_none(healthy: OrderTrackedResponse) -> None:
    bare = replace(healthy, runs=tuple(replace(run, trial_unbalance={}) for run in healthy.runs))
    assert trial_unbalance(bare, np.arange(3)) == {}
