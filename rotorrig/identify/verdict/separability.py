"""Separability of two causes by a set of recordings: lambda, the misfit left when one is fitted by the other.

lambda_ij is chi2 of the best fit of cause j, base parameters and priors included, to the noise-free prediction of cause
i, weighted by the noise of the data at hand. With noise, chi2 of j exceeds that of i by lambda on average, so a
difference of 16 is one of four standard deviations. Nothing here looks at what was measured.
"""

import math
from collections.abc import Sequence

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem
from rotorrig.identify.least_squares import Solution, Worth, always
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect


def separability(truth: ExtendedProblem, p: Reals, rival: Sequence[Effect], *, enough: float = math.inf) -> float:
    """Return lambda of the prediction of `truth` at `p` when it is fitted by the effects in `rival`.

    A fit that could not come below `enough` is given up: what is returned is then some value above it.
    """
    recordings = [r.instead(z) for r, z in zip(truth.recordings, truth.model.predict(p), strict=True)]
    problem = ExtendedProblem(ExtendedModel(recordings, rival, models=truth.model.models, widened=truth.model.widened))
    own = truth.parameters.prior_residual(p)
    floor = float(own @ own)
    hoped = VERDICT.hoped_of_laws if problem.curved or truth.curved else VERDICT.hoped

    def worth(chi2: float, promise: float) -> bool:
        return chi2 - hoped * promise < enough + floor

    return max(0.0, fit_from_starts(problem, problem.parameters.start(p), worth=worth).chi2 - floor)


def fit_from_starts(problem: ExtendedProblem, base: Reals, *, worth: Worth = always) -> Solution:
    """Fit a problem from a vector of base parameters, its effects from each of their starts; return the best.

    A start is where the parameters of an effect that name several begin, all the first, all the second.. together;
    one at which there is no motion is passed over. The fit is given up where `worth` says so, as least_squares.solve
    has it. Raises DataError if there is no motion at any start.
    """
    start = problem.parameters.start(base)
    with np.errstate(over="ignore", invalid="ignore"):  # steps that go too far, and are taken back
        if problem.effects:
            start = _best_start(problem, start)
        return problem.solve(start, tolerance=VERDICT.separated_within, max_steps=VERDICT.separated_steps, worth=worth)


def _best_start(problem: ExtendedProblem, start: Reals) -> Reals:
    """Return the start that misses the recordings least."""
    starts: list[tuple[float, Reals]] = []
    failed: DataError | None = None
    for k in range(_starts(problem)):
        try:
            p = _start_at(problem, start, k)
            starts.append((float(np.sum(problem.residual(p) ** 2)), p))
        except DataError as error:
            failed = error
    if failed is not None and not starts:
        raise failed
    return min(starts, key=lambda each: each[0])[1]


def _starts(problem: ExtendedProblem) -> int:
    return max((len(q.starts) for effect in problem.effects for q in effect.parameters), default=0) or 1


def _start_at(problem: ExtendedProblem, start: Reals, k: int) -> Reals:
    """Return `start` with every unknown that names starts at its k-th, the linear ones at their best."""
    p = start.copy()
    own = [q for effect in problem.effects for q in effect.parameters]
    for i, q in zip(range(problem.parameters.own.start, len(p)), own, strict=True):
        if q.starts:
            p[i] = q.starts[min(k, len(q.starts) - 1)] / q.size
    return problem.solve_linear(p, np.arange(len(p)))
