"""Forecast of a planned run: how near its vibration comes to the limits, by every model that the data leave open."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.verdict.next_run.planned_recordings import plan_recordings
from rotorrig.identify.verdict.next_run.plans import Plan
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.rig import DataError
from rotorrig.rig.config import Limits


def planned_truth(problem: ExtendedProblem, fitted: Reals, plan: Plan) -> tuple[ExtendedProblem, Reals]:
    """Return the problem of the recordings with that of a plan and the effects of `problem`, its unknowns `fitted`."""
    recordings, unknown = plan_recordings(plan, problem.recordings)
    truth = ExtendedProblem(ExtendedModel(recordings, (*unknown, *problem.effects), widened=problem.model.widened))
    return truth, carry_over(truth, problem, fitted)


def carry_over(truth: ExtendedProblem, problem: ExtendedProblem, fitted: Reals) -> Reals:
    """Return the unknowns of a planned problem: those of the fit by name, all others as they start."""
    named = dict(zip(problem.parameters.names, fitted, strict=True))
    start = truth.parameters.start(fitted[:0])
    return np.array([named.get(name, value) for name, value in zip(truth.parameters.names, start, strict=True)])


def share_of_limit(problem: ExtendedProblem, left_open: Sequence[Reals], plan: Plan, limits: Limits) -> float:
    """Return the largest 0-peak vibration of a plan over its limit: what a fitted model leaves open is below by 95 %.

    `left_open` as of `draw_left_open`, the fit first. The sum of the amplitudes of all orders stands for the 0-peak
    value. A draw at which the plan has no motion is passed over. Raises DataError if there is none at the fit itself.
    """
    truth, p = planned_truth(problem, left_open[0], plan)
    shares = [_predict_share(truth, p, limits)]
    for each in left_open[1:]:
        with suppress(DataError):
            shares.append(_predict_share(truth, carry_over(truth, problem, each), limits))
    return max(shares[0], float(np.quantile(shares, 0.95, method="higher")))


def draw_left_open(problem: ExtendedProblem, fit: Solution) -> list[Reals]:
    """Return a fit and vectors that the data leave open beside it, drawn from its covariance.

    What the data do not determine has a covariance that leads out of all they say, to unbalances beyond any and rotors
    that are unstable. Where draws do so, each principal axis of the covariance is first shortened by itself, so that
    what is determined keeps its spread. The covariance is scaled up where the fit is worse than the noise, and so is
    the rise of chi2 that is expected.
    """
    scale = max(1.0, fit.chi2 / max(fit.dof, 1))
    variance, ways = np.linalg.eigh(np.where(np.isfinite(fit.covariance), fit.covariance, 0.0))
    axes = ways * np.sqrt(np.maximum(variance, 0.0))  # (unknown, axis), one standard deviation each
    drawn = np.random.default_rng(0).standard_normal((VERDICT.draws, len(fit.p)))
    expected = scale * np.sum(drawn**2, axis=1)
    steps = drawn @ axes.T
    if any(_leads_too_far(problem, fit, step, expected=e) for step, e in zip(steps, expected, strict=True)):
        shortened = np.array(_shorten_apart(problem, fit, axes.T, scale=scale))
        pairs = zip(drawn @ shortened, expected, strict=True)
        steps = np.array([_shorten(problem, fit, step, expected=e) for step, e in pairs])
    return [np.clip(fit.p + step, *problem.bounds) for step in (np.zeros(len(fit.p)), *steps)]


def _shorten_apart(problem: ExtendedProblem, fit: Solution, axes: Reals, *, scale: float) -> list[Reals]:
    """Return axes (axis, unknown), each shortened by itself; those that need not be are told by halves, together.

    They are sorted by length, and it is the longest that lead too far. What one hides among many is left to the limit
    that holds for every draw.
    """
    if len(axes) == 1:
        return [_shorten(problem, fit, axes[0], expected=scale)]
    if not _leads_too_far(problem, fit, axes.sum(axis=0), expected=scale * len(axes)):
        return list(axes)
    half = len(axes) // 2
    return [each for part in (axes[:half], axes[half:]) for each in _shorten_apart(problem, fit, part, scale=scale)]


def _shorten(problem: ExtendedProblem, fit: Solution, step: Reals, *, expected: float) -> Reals:
    """Return a step from a fit, halved until it leads no longer too far; none at last."""
    halved = (step / 2**times for times in range(VERDICT.halved + 1))
    near = (each for each in halved if not _leads_too_far(problem, fit, each, expected=expected))
    return next(near, np.zeros_like(step))


def _leads_too_far(problem: ExtendedProblem, fit: Solution, step: Reals, *, expected: float) -> bool:
    """Say whether chi2 rises by more than twice what is `expected` of a step from a fit."""
    return not problem.sum_squares(np.clip(fit.p + step, *problem.bounds)) <= fit.chi2 + 2 * expected


def _predict_share(truth: ExtendedProblem, p: Reals, limits: Limits) -> float:
    """Return the largest 0-peak vibration of the planned recordings over its limit, at these unknowns.

    A motion so large that it overflows is over every limit.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        largest = _largest_share(truth, p, limits)
    return largest if np.isfinite(largest) else np.inf


def _largest_share(truth: ExtendedProblem, p: Reals, limits: Limits) -> float:
    largest = 0.0
    for recording, vectors in zip(truth.recordings, truth.model.predict(p), strict=True):
        if not recording.planned:
            continue
        response = recording.response
        amplitude = sum(np.abs(z[: len(response.omega)]) for order, z in vectors.items() if order)
        share = float(np.max(amplitude / _find_limits(response.omega, response.probes, limits)))
        largest = float(np.maximum(largest, share))  # NaN stays
    return largest


def _find_limits(omega: Reals, probes: tuple[str, ...], limits: Limits) -> NDArray[np.float64]:
    """Return the limits (row, probe) [m] at speeds [rad/s], of critical bands within them."""
    allowed = np.tile([limits.probes.get(name, limits.vibration) for name in probes], (len(omega), 1))
    for band in limits.critical_bands:
        inside = (omega >= band.low) & (omega <= band.high)
        allowed[inside] = [band.probes.get(name, band.vibration) for name in probes]
    return allowed
