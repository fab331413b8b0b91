"""Separability of two causes by a set of recordings: lambda, the misfit left when one is fitted by the other.

lambda_ij is chi2 of the best fit of cause j, base parameters and priors included, to the noise-free prediction of cause
i, weighted by the noise of the data at hand. With noise, chi2 of j exceeds that of i by lambda on average, so a
difference of 16 is one of four standard deviations. Nothing here looks at what was measured.
"""

import itertools
import math
from collections.abc import Iterator, Sequence

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

    Effects that need starts begin at the best combination of them; one at which there is no motion is passed over. The
    fit is given up where `worth` says so, as least_squares.solve has it. Raises DataError if there is no motion
    at any start.
    """
    start = problem.parameters.start(base)
    with np.errstate(over="ignore", invalid="ignore"):  # steps that go too far, and are taken back
        if problem.effects:
            start = _best_start(problem, start)
        return problem.solve(start, tolerance=VERDICT.separated_within, max_steps=VERDICT.separated_steps, worth=worth)


def _best_start(problem: ExtendedProblem, start: Reals) -> Reals:
    """Return the start that misses the recordings least, under force laws of the few that miss some rows least."""
    if not problem.curved:
        return problem.solve_linear(start, np.arange(len(start)))
    starts = list(_starts(problem, start))
    if any("force laws" in effect.acts_on for effect in problem.effects):
        thin, index = problem.thinned(start, count=VERDICT.separated_rows)
        missed = np.array([_missed(thin, p[index])[0] for p in starts])
        starts = [starts[i] for i in np.argsort(missed)[: VERDICT.separated_starts]]
    chi2, best = min((_missed(problem, p) for p in starts), key=lambda each: each[0])
    if math.isinf(chi2):
        raise DataError(f"{problem.effects[-1].label}: at none of its starts a motion is found, want one")
    return best


def _starts(problem: ExtendedProblem, start: Reals) -> Iterator[Reals]:
    """Yield `start` with the effects at every combination of their starts."""
    for begins in itertools.product(*(effect.starts for effect in problem.effects)):
        p, values = start.copy(), zip(problem.effects, begins, strict=True)
        p[problem.parameters.own] = [theta[q.name] / q.size for effect, theta in values for q in effect.parameters]
        yield p


def _missed(problem: ExtendedProblem, p: Reals) -> tuple[float, Reals]:
    """Return chi2 at `p` with the linear unknowns at their best, and these; infinite where there is no motion."""
    try:
        p = problem.solve_linear(p, np.arange(len(p)))
        return float(np.sum(problem.residual(p) ** 2)), p
    except DataError:
        return math.inf, p
