"""How far apart two causes are for a set of recordings: lambda, the misfit left when one is fitted by the other.

lambda_ij is chi2 of the best fit of cause j, base parameters and priors included, to the noise-free prediction of cause
i, weighted by the noise of the data at hand. With noise, chi2 of j exceeds that of i by lambda on average, so a
difference of 16 is one of four standard deviations. Nothing here looks at what was measured.
"""

from collections.abc import Sequence

import numpy as np

from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.parameters import Reals
from rotorrig.identify.solving import Polished
from rotorrig.sims.effects.base import Effect

DETECTABLE = 25.0  # lambda against the base
NAMEABLE = 16.0  # against the nearest other cause

_ACCURATE = 0.3  # of chi2
_STEPS = 10


def separation(truth: ExtendedProblem, p: Reals, rival: Sequence[Effect]) -> float:
    """Return lambda of the prediction of `truth` at `p` when it is fitted by the effects in `rival`."""
    recordings = [r.instead(z) for r, z in zip(truth.recordings, truth.predict(p), strict=True)]
    problem = ExtendedProblem(recordings, rival, models=truth.models)
    own = truth.parameters.prior_residual(p)
    return max(0.0, fitted(problem, problem.parameters.start(p)).chi2 - float(own @ own))


def fitted(problem: ExtendedProblem, base: Reals) -> Polished:
    """Fit a problem from a vector of base parameters, its effects from each of their starts; return the best.

    A start is where the parameters of an effect that name several begin, all the first, all the second.. together.
    """
    names = problem.parameters
    start = names.start(base)
    if not problem.effects:
        return problem.solve(start, tolerance=_ACCURATE, max_steps=_STEPS)
    begun = [_begun(problem, start, k) for k in range(_starts(problem))]
    costs = [float(np.sum(problem.residual(p) ** 2)) for p in begun]
    return problem.solve(begun[int(np.argmin(costs))], tolerance=_ACCURATE, max_steps=_STEPS)


def _starts(problem: ExtendedProblem) -> int:
    return max((len(q.starts) for effect in problem.effects for q in effect.parameters), default=0) or 1


def _begun(problem: ExtendedProblem, start: Reals, k: int) -> Reals:
    """Return `start` with every unknown that names starts at its k-th, the linear ones at their best."""
    p = start.copy()
    own = [q for effect in problem.effects for q in effect.parameters]
    for i, q in zip(range(problem.parameters.own.start, len(p)), own, strict=True):
        if q.starts:
            p[i] = q.starts[min(k, len(q.starts) - 1)] / q.size
    return problem.settled(p, np.arange(len(p)))
