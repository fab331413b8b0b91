"""Whitening: residuals drawn from the covariance come out with unit variance, masked vectors play no part."""

from dataclasses import replace

import numpy as np

from rotorrig.identify.measurement.whitened_rows import measure, trial_unbalance
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


def test_louder_rows_have_so_much_more_variance_and_the_slow_roll_stays(blind_response: OrderTrackedResponse) -> None:
    measured = measure(blind_response)
    factor = np.linspace(1.0, 4.0, len(measured.rows))
    louder = measured.louder(factor)
    off = np.full(measured.z.shape, 1e-7 + 2e-7j)
    ratio = measured.sigmas(off)[:-1] / louder.sigmas(off)[:-1]
    np.testing.assert_allclose(ratio**2, np.broadcast_to(factor[:, None], ratio.shape), rtol=1e-9)
    np.testing.assert_array_equal(measured.sigmas(off)[-1], louder.sigmas(off)[-1])
    np.testing.assert_allclose(louder.sigma[:-1] ** 2, measured.sigma[:-1] ** 2 * factor[:, None])


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


def test_of_a_compensated_table_every_row_counts_less_the_slow_roll_and_that_not_at_all(
    blind_response: OrderTrackedResponse, rng: np.random.Generator
) -> None:
    nothing = np.full_like(blind_response.slow_roll, np.nan)
    measured = measure(replace(blind_response, slow_roll=nothing, slow_roll_omega=np.nan, compensation_omega=50.0))
    raw = rng.standard_normal(measured.z.shape) + 1j * rng.standard_normal(measured.z.shape)
    np.testing.assert_allclose(measured.as_stated(raw)[:-1], raw[:-1] - raw[-1])
    np.testing.assert_allclose(measured.sigmas(raw), measured.sigmas(measured.as_stated(raw)))
    np.testing.assert_allclose(measured.sigmas(raw + 1e-3), measured.sigmas(raw), rtol=1e-6, atol=1e-6)
    assert not measured.usable[-1].any()
    assert (measured.sigmas(raw)[-1] == 0).all()
    kept = measure(blind_response)
    assert kept.as_stated(raw) is raw


def test_harmonics_of_a_motion_that_no_curve_of_a_probe_follows_are_left_out(
    blind_response: OrderTrackedResponse,
) -> None:
    z = blind_response.z.copy()
    z[12, 1, blind_response.orders.index(1.0)] = 401e-6j
    z[13, 1, blind_response.orders.index(1.0)] = 399e-6j
    louder = replace(blind_response, z=z)
    first, second = measure(louder, order=1.0), measure(louder, order=2.0)
    at = [int(np.flatnonzero(second.rows == row)[0]) for row in (12, 13)]
    assert first.usable[at].all()
    assert second.usable[at[0]].tolist() == [True, False, True, True]
    assert second.usable[at[1]].all()
