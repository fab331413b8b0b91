"""Start values of force laws: their fits with pinned nuisances.

A strong force law biases the base, gains and masses included, by many of their standard deviations, and from there
its own fit does not converge to the truth. With those nuisances pinned the base cannot absorb the law, and stays near
the true rotor: bearings, damping and unbalance alone then lead to the law's size from nearly any start, the better
the weaker it is there. Laws compete: the one that the first look favours is fitted first, and those that do not
come near are given up.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.score_test import Score
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import LinearModel, Solution, Stop
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect, Parameter


def score_force_laws(
    problem: ExtendedProblem, polished: Solution, plain: Solution, candidates: Sequence[Effect]
) -> list[Score]:
    """Score effects that need starts, beside those of `problem`; best first.

    `plain` is its `fit_with_pinned_nuisances`. The score is by how much chi2 is below that of `polished`, the nuisances
    at their priors, and what a full step with all of them promises beyond. Of one that was given up it is the first
    part alone.
    """
    pinned = problem.parameters.pinned
    looks = [
        look for effect in candidates if effect.needs_starts and (look := _look(problem, plain.p, effect)) is not None
    ]
    scores: list[Score] = []
    best = plain.chi2
    for look in sorted(looks, key=lambda look: look.chi2):
        fit = _fit(look, pinned, limit=plain.chi2 - SELECTION.behind * (plain.chi2 - best))
        best = min(best, fit.chi2)
        more = 0.0 if fit.stop is Stop.GIVEN_UP else _promise(look.problem, fit)
        lam = polished.chi2 - fit.chi2 + more
        scores.append(Score(effect=look.effect, lam=lam, step=np.zeros(0), visible=0.0, begin=fit.p))
    return sorted(scores, key=lambda score: -score.lam)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Look:
    """A first look at a law, at its best start."""

    problem: ExtendedProblem  # with the law
    effect: Effect
    begin: Reals  # (parameter,)
    chi2: float  # of 1X and the priors, there


def _look(problem: ExtendedProblem, p: Reals, effect: Effect) -> _Look | None:
    """Return the start where chi2 is least beside the base `p`; None if the rotor moves at none."""
    larger = problem.extended((*problem.effects, effect))
    best: _Look | None = None
    for theta in _starts(effect.parameters):
        begin = np.append(p, theta)
        try:
            r = larger.residual(begin, orders=(1,))
        except DataError:
            continue
        chi2 = float(r @ r)
        if np.isfinite(chi2) and (best is None or chi2 < best.chi2):
            best = _Look(problem=larger, effect=effect, begin=begin, chi2=chi2)
    return best


def _starts(parameters: Sequence[Parameter]) -> Iterator[Reals]:
    """Yield the starts of an effect in sizes, (parameter,), weak ones first, none of them twice.

    Its strength is the first unknown with starts whose value at zero amplitude is 0.
    """
    strength = next(q.name for q in parameters if q.starts and q.at_zero == 0)
    count = max(len(q.starts) for q in parameters)
    seen: set[tuple[float, ...]] = set()
    for share in SELECTION.weak:
        for k in range(count):
            value = {q.name: q.starts[min(k, len(q.starts) - 1)] if q.starts else q.at_zero for q in parameters}
            value[strength] *= share
            start = tuple(value[q.name] / q.size for q in parameters)
            if start not in seen:
                seen.add(start)
                yield np.array(start)


def _fit(look: _Look, pinned: dict[int, float], *, limit: float) -> Solution:
    """Fit a law from its first look, the nuisances pinned, as long as chi2 may come below `limit`."""

    def worth(chi2: float, promise: float) -> bool:
        return chi2 - SELECTION.hoped * promise < limit

    begin = np.clip(look.begin, *look.problem.bounds)
    return look.problem.solve(
        begin, fixed=pinned, tolerance=SELECTION.pinned_settled, max_steps=SELECTION.steps, worth=worth
    )


def _promise(problem: ExtendedProblem, fit: Solution) -> float:
    """Return by how much chi2 would fall with every unknown free, by the derivatives at a fit."""
    frozen = problem.parameters.frozen
    free = np.setdiff1d(np.arange(len(fit.p)), list(frozen))
    low, high = problem.bounds
    r = problem.residual(fit.p)
    model = LinearModel(problem.jacobian(fit.p, free), r, fit.p[free], (low[free], high[free]))
    return model.promise(model.best(0.0))
