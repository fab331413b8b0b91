"""The adequacy tests on residuals of known distribution: chi2 in closed form says what they find and how often.

In sigmas of a component, the mean square of a stretch of n rows is chi2 of 2 n degrees of freedom over 2 n.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from rotorrig.identify.adequacy.residual_tests import Adequacy, assess, assess_all, residual_maps
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.processing.response import OrderTrackedResponse, Run
from tests.parameters import defer_rest

ROWS = 6000 * ADEQUACY.stretch
SIGMA = 0.3e-6  # m, of re or im
ONCE = 1e-4  # how seldom one of these tests may fail on another seed
Complex = NDArray[np.complex128]


@pytest.fixture
def judged(healthy: OrderTrackedResponse) -> Callable[..., Adequacy]:
    """Judge a residual (row, probe) [m] of one long run at 1X about a model that is right but for it."""

    def judge(residual: Complex) -> Adequacy:
        response = long_run(healthy, residual)
        return assess(response, {1: response.z[..., 0] - residual})

    return judge


def long_run(like: OrderTrackedResponse, residual: Complex) -> OrderTrackedResponse:
    rows, probes = residual.shape
    covariance = np.broadcast_to(SIGMA**2 * np.eye(2 * probes), (rows, 1, 2 * probes, 2 * probes))
    t = np.arange(rows, dtype=float)
    return replace(
        like,
        rig=like.rig.model_copy(update={"probes": like.rig.probes[:probes]}),
        probes=like.probes[:probes],
        orders=(1.0,),
        runs=(Run(name="up", direction=1),),
        run=np.zeros(rows, dtype=np.intp),
        t=t,
        omega=50 + 300 * t / rows,
        alpha=np.full(rows, 300 / rows),
        revolutions=np.full(rows, 8.0),
        z=(20e-6 + residual)[..., None],
        covariance=covariance,
        slow_roll=np.full((probes, 1), 20e-6 + 0j),
        slow_roll_covariance=covariance[0],
        usable=np.ones((rows, probes), dtype=bool),
        reasons=((),) * rows,
        keyphasor_t=np.empty(0),
    )


def white(rng: np.random.Generator, rows: int = ROWS, probes: int = 1) -> Complex:
    return SIGMA * (rng.standard_normal((rows, probes)) + 1j * rng.standard_normal((rows, probes)))


def loud_stretches(found: Adequacy) -> int:
    return sum(misfit.sigma > found.limit for misfit in found.misfits)


def test_white_residuals_have_sigma_one_and_their_worst_stretch_is_that_of_chi2(judged, rng) -> None:
    found = judged(white(rng))
    scatter = found.sigmas[np.isfinite(found.sigmas)] ** 2
    assert len(scatter) == ROWS
    assert scatter.mean() == pytest.approx(1.0, abs=4 / np.sqrt(ROWS))
    low, high = (share ** (ADEQUACY.stretch / ROWS) for share in (ONCE, 1 - ONCE))  # of the largest of so many
    worst = stats.chi2.cdf(found.worst_sigma**2 * 2 * ADEQUACY.stretch, 2 * ADEQUACY.stretch)
    assert low < worst < high
    assert found.adequate
    assert loud_stretches(found) == 0


@pytest.mark.parametrize("louder", defer_rest([1.0, 2.0]))
def test_noise_alone_is_called_inadequate_no_more_often_than_stated(judged, rng, louder: float) -> None:
    """Be it as loud as the covariance says or not: it is held against its own scatter."""
    draws = 400
    alarms = sum(not judged(louder * white(rng, 200, probes=2)).adequate for _ in range(draws))
    assert alarms <= stats.binom.isf(ONCE, draws, ADEQUACY.false_alarm_rate)


def test_the_ratio_of_noise_alone_has_the_variance_of_von_neumann(healthy, rng) -> None:
    """One over the number of values, about 1."""
    ratios = []
    for _ in range(300):
        response = long_run(healthy, residual := white(rng, 100, probes=2))
        ratios.append(assess(response, {1: response.z[..., 0] - residual}).scatter_ratio)
    assert np.mean(ratios) == pytest.approx(1.0, abs=4 / np.sqrt(300 * 400))
    assert np.var(ratios) * 400 == pytest.approx(1.0, abs=4 * np.sqrt(2 / 300))


@pytest.mark.parametrize("size", [3.7, 4.0, 4.3], ids="{} sigma".format)
def test_an_offset_of_a_stretch_is_found_as_often_as_noncentral_chi2_says(judged, rng, size: float) -> None:
    """One stretch of 32 is off, so that none is joined with another and the scatter stays what it is."""
    residual = white(rng)
    off = np.arange(ROWS) // ADEQUACY.stretch % 32 == 0
    residual[off] += size * SIGMA * np.exp(0.7j)
    found = judged(residual)
    values = 2 * ADEQUACY.stretch
    power = stats.ncx2.sf(found.limit**2 * values, values, ADEQUACY.stretch * size**2)
    low, high = stats.binom.interval(1 - ONCE, ROWS // ADEQUACY.stretch // 32, power)
    assert low <= loud_stretches(found) <= high


def test_what_is_loud_is_located_and_makes_the_model_inadequate(judged, rng) -> None:
    residual = white(rng, 400, probes=2)
    residual[160:176, 1] += 8 * SIGMA
    found = judged(residual)
    assert not found.adequate
    (misfit,) = found.misfits
    assert (misfit.order, misfit.speed_from, misfit.speed_to) == (
        1,
        pytest.approx(170, abs=1),
        pytest.approx(181.25, abs=1),
    )
    assert misfit.sigma == pytest.approx(np.sqrt(1 + 8**2 / 2), rel=0.15)


@pytest.mark.parametrize(("coherent", "adequate"), [(False, True), (True, False)])
def test_noise_that_rings_where_half_the_speed_passes_the_critical_one_is_no_misfit(
    healthy, rng, *, coherent: bool, adequate: bool
) -> None:
    """Fourteen rows of half-order vibration, five times the noise: shaken anew in every row, or one and the same."""
    rows = 400
    ringing = 5 * np.exp(-(((np.arange(rows) - 200) / 10) ** 2))[:, None]
    added = ringing * (np.full((rows, 2), SIGMA + 0j) if coherent else white(rng, rows, probes=2))
    half = white(rng, rows, probes=2) + added
    response = long_run(healthy, white(rng, rows, probes=2))
    response = replace(
        response,
        orders=(1.0, 0.5),
        z=np.stack([response.z[..., 0], half], axis=-1),
        covariance=np.repeat(response.covariance, 2, axis=1),
        slow_roll=np.stack([response.slow_roll[:, 0], np.zeros(2)], axis=-1),
        slow_roll_covariance=np.repeat(response.slow_roll_covariance, 2, axis=0),
    )
    found = assess(response, {1: np.full((rows, 2), 20e-6 + 0j)})
    assert found.adequate is adequate
    assert adequate or found.misfits[0].order == 0.5


@pytest.mark.parametrize(("size", "adequate"), [(0.2, True), (0.7, False)])
def test_the_global_test_alone_can_refuse_what_is_smooth_and_loud_nowhere(
    judged, rng, size: float, adequate: bool
) -> None:
    residual = white(rng, 800, probes=2)
    residual += size * SIGMA * np.exp(1j * np.linspace(0, 20, 800))[:, None]
    found = judged(residual)
    assert loud_stretches(found) == 0
    assert found.adequate is adequate
    assert found.scatter_ratio == pytest.approx(1 + size**2 / 2, abs=4 / np.sqrt(3200))


def test_values_that_the_fit_could_follow_are_not_counted(healthy, rng) -> None:
    response = long_run(healthy, white(rng, 200, probes=2))
    model = np.full((200, 2), 20e-6 + 0j)
    whole, fewer = (assess(response, {1: model}, used=used).scatter_ratio for used in (0.0, 80.0))
    assert fewer == pytest.approx(whole * 800 / 720)


def test_of_several_responses_the_worst_decides_and_its_chances_are_paid_for(judged, rng) -> None:
    good, bad = white(rng, 400), white(rng, 400)
    bad[160:176, 0] += 8 * SIGMA
    alone, wrong = judged(good), judged(bad)
    both = assess_all([alone, wrong])
    assert not both.adequate
    assert both.misfits[0].sigma == wrong.misfits[0].sigma
    assert both.sigmas.shape == (800, 1, 1)
    twice = assess_all([alone, alone])
    assert twice.p == pytest.approx(1 - (1 - alone.p) ** 2)


def test_an_order_of_which_nothing_is_predicted_is_held_against_its_slow_roll(healthy, rng) -> None:
    residual = white(rng, 400)
    residual[200:, 0] += 5e-6
    got, sigmas = residual_maps(long_run(healthy, residual), {})
    np.testing.assert_allclose(got[..., 0], residual, atol=1e-15)
    np.testing.assert_allclose(sigmas[..., 0], np.abs(residual) / (np.sqrt(2) * SIGMA), rtol=0.1)  # as they scatter
