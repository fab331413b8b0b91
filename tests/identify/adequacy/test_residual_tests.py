"""The adequacy tests on residuals of known distribution: chi2 in closed form says what they find and how often.

In sigmas of a component, the mean square of a stretch of n rows is chi2 of 2 n degrees of freedom over 2 n.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from rotorrig.identify.adequacy.residual_tests import Adequacy, assess, residual_maps
from rotorrig.identify.adequacy.settings import ADEQUACY
from rotorrig.processing.response import OrderTrackedResponse, Run

ROWS = 6000 * ADEQUACY.stretch
SIGMA = 0.3e-6  # m, of re or im
ONCE = 1e-4  # how seldom one of these tests may fail on another seed
Complex = NDArray[np.complex128]


@pytest.fixture
def judged(healthy: OrderTrackedResponse) -> Callable[..., Adequacy]:
    """Judge a residual (row, probe) [m] of one long run at 1X about a model that is right but for it."""

    def judge(residual: Complex, *, reduced_chi2: float = 0.6) -> Adequacy:
        response = long_run(healthy, residual)
        return assess(response, {1: response.z[..., 0] - residual}, reduced_chi2=reduced_chi2)

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
    return sum(misfit.sigma > ADEQUACY.focused_limit for misfit in found.misfits)


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


def test_an_alarm_on_white_residuals_is_out_of_the_question() -> None:
    """The limit stands where errors of a scale factor, not noise, put it: docs/adequacy.md."""
    assert stats.chi2.sf(ADEQUACY.focused_limit**2 * 2 * ADEQUACY.stretch, 2 * ADEQUACY.stretch) < 1e-12


@pytest.mark.parametrize("size", [2.9, 3.2, 3.5], ids="{} sigma".format)
def test_an_offset_of_a_stretch_is_found_as_often_as_noncentral_chi2_says(judged, rng, size: float) -> None:
    """Every fourth stretch is off, so that none is joined with another."""
    residual = white(rng)
    off = np.arange(ROWS) // ADEQUACY.stretch % 4 == 0
    residual[off] += size * SIGMA * np.exp(0.7j)
    power = stats.ncx2.sf(
        ADEQUACY.focused_limit**2 * 2 * ADEQUACY.stretch, 2 * ADEQUACY.stretch, ADEQUACY.stretch * size**2
    )
    low, high = stats.binom.interval(1 - ONCE, ROWS // ADEQUACY.stretch // 4, power)
    assert low <= loud_stretches(judged(residual)) <= high


def test_residuals_that_stay_through_a_stretch_are_found_as_often_as_one_row_is(judged, rng) -> None:
    """Neighbours off together leave chi2 of two degrees of freedom: exp(-limit^2) of the stretches are loud."""
    residual = np.repeat(white(rng, ROWS // ADEQUACY.stretch), ADEQUACY.stretch, axis=0)
    alone = np.arange(ROWS) // ADEQUACY.stretch % 4 == 0
    residual[~alone] = 0
    low, high = stats.binom.interval(1 - ONCE, ROWS // ADEQUACY.stretch // 4, np.exp(-(ADEQUACY.focused_limit**2)))
    assert low <= loud_stretches(judged(residual)) <= high


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


@pytest.mark.parametrize(("reduced_chi2", "adequate"), [(1.0, True), (1.001, False)])
def test_the_global_test_alone_can_refuse(judged, rng, reduced_chi2: float, adequate: bool) -> None:
    assert judged(white(rng, 400), reduced_chi2=reduced_chi2).adequate is adequate


def test_an_order_of_which_nothing_is_predicted_is_held_against_its_slow_roll(healthy, rng) -> None:
    residual = white(rng, 400)
    residual[200:, 0] += 5e-6
    got, sigmas = residual_maps(long_run(healthy, residual), {})
    np.testing.assert_allclose(got[..., 0], residual, atol=1e-15)
    sigma = np.hypot(SIGMA, healthy.rig.prior.probe_linearity * np.abs(residual))  # the scale factor errs besides
    np.testing.assert_allclose(sigmas[..., 0], np.abs(residual) / (np.sqrt(2) * sigma), rtol=1e-9)
