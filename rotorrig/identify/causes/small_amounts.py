"""Scores of causes that need starts and yet have a first order: in one unknown, at each start of the others.

A pedestal that gives way by little does so in proportion, whatever its frequency, and a spring may harden by little as
well as soften. What a fit finds from a full amount need not come down to that. So what a small amount would do is
scored at every start of the other unknowns: by some rows of the first recording at 1X, their speed taken as steady, and
where that is best by all rows and orders.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.score_test import Score, projection, score_beyond
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect

NO_MOTION = (DataError, np.linalg.LinAlgError)  # at some unknowns a rotor has none, or none that is finite


def score_small_amounts(problem: ExtendedProblem, p: Reals, candidates: Sequence[Effect]) -> list[Score]:
    """Return the scores of the effects that are linear in one unknown while that is small, at the fit `p`."""
    able = [effect for effect in candidates if effect.linear_in]
    if not able:
        return []
    steady, index = problem.thinned(p, count=SELECTION.scanned_rows)
    scan, whole = _Fitted.of(steady, p[index]), _Fitted.of(problem, p)
    found = []
    for effect in able:
        begun = _at_starts_of_others(effect)
        try:
            before = scan.residual_without(effect)
            best = max(begun, key=lambda each: scan.score(each, before).lam) if len(begun) > 1 else begun[0]
            found.append(replace(whole.score(best, whole.residual_without(effect)), effect=effect))
        except NO_MOTION:
            continue
    return found


def _at_starts_of_others(effect: Effect) -> list[Effect]:
    """Return the effect with nothing of what it is linear in, its other unknowns at each of their starts."""
    others = dict.fromkeys(tuple(v for name, v in start.items() if name != effect.linear_in) for start in effect.starts)
    names = [q.name for q in effect.parameters if q.name != effect.linear_in]
    guesses = tuple(dict(zip(names, values, strict=True)) for values in others)
    return list(replace(effect, initial_guesses=guesses).at_initial_guesses())


@dataclass(frozen=True, slots=True, kw_only=True)
class _Fitted:
    """A problem at its fit."""

    problem: ExtendedProblem
    p: Reals
    Q: Reals  # an orthonormal basis of what its unknowns can do
    r: Reals  # the residual beyond that

    @classmethod
    def of(cls, problem: ExtendedProblem, p: Reals) -> "_Fitted":
        Q, r = projection(problem, p)
        return cls(problem=problem, p=p, Q=Q, r=r)

    def residual_without(self, effect: Effect) -> Reals:
        """Return the residual with an effect at nothing: computed as with a little of it, rounding apart."""
        return self._residual(effect, [q.at_zero / q.size for q in effect.parameters])

    def score(self, effect: Effect, before: Reals) -> Score:
        """Score an effect by a little of what it is linear in, `before` that; it begins with what that promises."""
        nothing, low, high = np.array(
            [(q.at_zero / q.size, q.low / q.size, q.high / q.size) for q in effect.parameters]
        ).T
        little = SELECTION.little * np.array([q.name == effect.linear_in for q in effect.parameters])
        after = self._residual(effect, nothing + little)
        columns = np.outer((after - before) / SELECTION.little, little > 0)
        score = score_beyond(effect, columns, self.Q, self.r)
        return replace(score, begin=np.append(self.p, np.clip(nothing + score.step, low, high)))

    def _residual(self, effect: Effect, own: ArrayLike) -> Reals:
        larger = self.problem.extended((*self.problem.effects, effect))
        return larger.residual(np.append(self.p, own))
