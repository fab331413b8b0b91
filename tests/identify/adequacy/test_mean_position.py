"""How the mean position moves is told from what a probe, a warm cable and the shaft's roundness make of it."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.adequacy.mean_position import departures
from rotorrig.identify.adequacy.residual_tests import Adequacy, assess
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.processing.response import OrderTrackedResponse, Run

SIGMA = 0.04e-6  # m, of a row's mean position


def with_gap(response: OrderTrackedResponse, gap: NDArray[np.float64], *, seed: int = 3) -> OrderTrackedResponse:
    """The response with the mean position `gap` (speed, probe) [m] and scatter, as order 0."""
    rng = np.random.default_rng(seed)
    noisy = gap + SIGMA * rng.standard_normal(gap.shape)
    own = np.broadcast_to(SIGMA**2 * np.eye(8), (len(gap), 1, 8, 8))
    return replace(
        response,
        orders=(0.0, *response.orders),
        z=np.concatenate([noisy[..., None].astype(complex), response.z], axis=2),
        covariance=np.concatenate([own, response.covariance], axis=1),
        slow_roll=np.concatenate([noisy[0][:, None].astype(complex), response.slow_roll], axis=1),
        slow_roll_covariance=np.concatenate([own[0], response.slow_roll_covariance]),
    )


def judged(response: OrderTrackedResponse) -> Adequacy:
    """The test of a model that is right at every order it predicts."""
    prediction = {int(n): response.order(n) for n in response.orders if n}
    return assess(response, prediction)


@pytest.fixture
def flat(healthy: OrderTrackedResponse) -> NDArray[np.float64]:
    return np.zeros(healthy.z.shape[:2])


def bump(response: OrderTrackedResponse, size: float) -> NDArray[np.float64]:
    """Which the mean position makes below the critical speeds, where the vibration is small: 1000 rpm."""
    return size * np.exp(-(((response.omega - 105.0) / 12.0) ** 2))


def test_a_shaft_that_stays_where_it_is_is_not_said_to_move(
    healthy: OrderTrackedResponse, flat: NDArray[np.float64]
) -> None:
    setting = flat + np.array([1e-3, 1.2e-3, 0.9e-3, 1.1e-3])
    for seed in range(20):
        assert judged(with_gap(healthy, setting, seed=seed)).centreline == ()


def test_a_bump_of_the_mean_is_found_with_its_probe_speed_size_and_the_other_run(
    healthy: OrderTrackedResponse, flat: NDArray[np.float64]
) -> None:
    flat[:, 2] = bump(healthy, 1e-6)
    found = judged(with_gap(healthy, flat)).centreline
    assert [m.run for m in found] in (["up", "down"], ["down", "up"])
    for misfit in found:
        assert misfit.order == 0
        assert misfit.probe == healthy.probes[2]
        assert misfit.speed_from < 105.0 < misfit.speed_to
        assert misfit.residual == pytest.approx(1e-6, rel=0.3)  # the line in time takes some of it
        assert misfit.sigma > ADEQUACY.position_limit
        assert np.isnan(misfit.backward)
        assert misfit.other_run.startswith("the same")
        assert "the mean position at probe 2x moves by up to" in misfit.sentence
        assert "0-peak" not in misfit.sentence


def test_it_decides_nothing(healthy: OrderTrackedResponse, flat: NDArray[np.float64]) -> None:
    flat[:, 2] = bump(healthy, 5e-6)
    found = judged(with_gap(healthy, flat))
    assert found.centreline
    assert found.adequate
    assert found.worst_sigma < found.limit
    assert all(m.order for m in found.misfits)


def test_an_even_drift_in_time_is_a_probe_that_warms_up(
    healthy: OrderTrackedResponse, flat: NDArray[np.float64]
) -> None:
    assert judged(with_gap(healthy, flat + 1e-7 * healthy.t[:, None])).centreline == ()


def test_the_mean_that_a_curved_scale_makes_of_a_vibration_is_the_probes(
    healthy: OrderTrackedResponse, flat: NDArray[np.float64]
) -> None:
    """r (1 + e r / 300 um) of r = A cos: on the mean e A^2 / (2 300 um)."""
    size = np.abs(healthy.order(1.0)) ** 2 / (2 * 300e-6)
    assert judged(with_gap(healthy, healthy.rig.prior.probe_linearity * size)).centreline == ()
    assert judged(with_gap(healthy, 30 * healthy.rig.prior.probe_linearity * size)).centreline


def test_a_round_shaft_recedes_from_a_probe_as_it_moves_aside(
    healthy: OrderTrackedResponse, flat: NDArray[np.float64]
) -> None:
    """By y^2 / 2R: sqrt(R^2 - y^2) - R; the probes of a plane are at right angles."""
    aside = np.abs(healthy.order(1.0))[:, [1, 0, 3, 2]]
    radius = healthy.rig.shaft.diameter / 2
    assert judged(with_gap(healthy, -(aside**2) / (4 * radius))).centreline == ()


def test_it_is_above_zero_towards_the_probe(healthy: OrderTrackedResponse, flat: NDArray[np.float64]) -> None:
    flat[:, 0] = bump(healthy, -1e-6)
    change, sigmas = departures(with_gap(healthy, flat))
    row = int(np.argmin(np.abs(healthy.omega - 105.0)))
    assert change[row, 0] == pytest.approx(-1e-6, abs=0.3e-6)
    assert sigmas[row, 0] < -ADEQUACY.position_limit


def test_what_is_not_usable_or_a_slow_roll_has_no_say(healthy: OrderTrackedResponse, flat: NDArray[np.float64]) -> None:
    usable = healthy.usable.copy()
    usable[5, 1] = False
    runs = (Run(name="slow roll", direction=0), healthy.runs[1])
    change, _ = departures(with_gap(replace(healthy, usable=usable, runs=runs), flat))
    assert np.isnan(change[healthy.run == 0]).all()
    change, _ = departures(with_gap(replace(healthy, usable=usable), flat))
    assert np.isnan(change[5, 1])
    assert np.isfinite(change[5, 0])


def test_without_the_gap_nothing_is_said(healthy: OrderTrackedResponse) -> None:
    assert np.isnan(departures(healthy)[0]).all()
    assert judged(healthy).centreline == ()
