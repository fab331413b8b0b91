"""Search for causes that no score of the first order finds, from the nameplate and not from a base that they biased.

The unknowns of an effect are searched together with the base's stiffness, damping and unbalance, on some rows of the
first recording, their speed taken as steady, in three stages. Gather: at each of the effect's starts, where a full step
of all these unknowns would lead. Cluster: the lowest few of them that are apart. Descend: from each, with nuisances
pinned at their priors; the lowest then with every unknown free. It begins at the nameplate and at the base's fit.

Those that are linear while small are scored for that as well: small_amounts.py.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import minimum_filter

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.score_test import Score
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.small_amounts import NO_MOTION, score_small_amounts
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Index, LinearModel, Solution
from rotorrig.sims.effects import Effect


def search_from_nameplate(
    problem: ExtendedProblem,
    polished: Solution,
    candidates: Sequence[Effect],
    *,
    go_on: Callable[[], bool] = lambda: True,
) -> list[Score]:
    """Score effects that need starts, beside those of `problem`, whose fit is `polished`, while `go_on`; best first.

    The score is the share of chi2 that the candidate takes on those rows, of the chi2 of `polished`.
    """
    able = [effect for effect in candidates if effect.needs_starts]
    if not able:
        return []
    search = _Search.of(problem, polished.p)
    scores: list[Score] = []
    for effect in able:
        if not go_on() or (near := search.descend(effect)) is None:
            continue
        fit = search.free(effect, near)
        begin = np.append(polished.p, fit.p[len(search.index) :])
        begin[search.index] = fit.p[: len(search.index)]
        lam = polished.chi2 * (1 - fit.chi2 / search.chi2)
        scores.append(Score(effect=effect, lam=lam, step=np.zeros(0), visible=0.0, begin=begin))
    scores += score_small_amounts(problem, polished.p, able) if go_on() else []
    return sorted(scores, key=lambda score: -score.lam)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Start:
    """A start of an effect beside a base, and where a full step from there would lead."""

    p: Reals
    chi2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search:
    """The rows searched, and the base there."""

    problem: ExtendedProblem
    index: Index  # of its unknowns in those of the whole problem
    bases: tuple[Reals, ...]  # where it begins: at the nameplate, and at the base's fit
    chi2: float  # of the base

    @classmethod
    def of(cls, whole: ExtendedProblem, p: Reals) -> "_Search":
        problem, index = whole.thinned(p, count=SELECTION.searched_rows)
        names = problem.parameters
        nameplate = _as_loud(problem, problem.begin(names.base.space.nameplate, p[index][names.own]))
        near = _solve(problem, p[index], 0.0, pinned=True)
        base = min((_solve(problem, start, 0.0) for start in (near.p, p[index])), key=lambda fit: fit.chi2)
        return cls(problem=problem, index=index, bases=(nameplate, near.p), chi2=base.chi2)

    def descend(self, effect: Effect) -> Solution | None:
        """Return the lowest fit of an effect with nuisances pinned; None if the rotor moves at none of its starts."""
        problem = self.problem.extended((*self.problem.effects, effect))
        ends: list[Solution] = []
        clusters = [start for base in self.bases for start in _cluster(self._gather(problem, base, effect), effect)]
        for start in sorted(clusters, key=lambda start: start.chi2)[: SELECTION.descents]:
            try:
                ends.append(_solve(problem, start.p, start.chi2, pinned=True))
            except NO_MOTION:
                continue
        return min(ends, key=lambda fit: fit.chi2, default=None)

    def free(self, effect: Effect, near: Solution) -> Solution:
        """Return the fit with every unknown free, to its end: what pinned nuisances spoil promises nothing there."""
        problem = self.problem.extended((*self.problem.effects, effect))
        try:
            return _solve(problem, near.p, 0.0)
        except NO_MOTION:
            return near

    def _gather(self, problem: ExtendedProblem, base: Reals, effect: Effect) -> Iterator[_Start]:
        """Yield every start of the effect beside a base."""
        names = problem.parameters
        free = np.setdiff1d(np.arange(len(names)), [*names.pinned, *names.frozen])
        low, high = (bound[free] for bound in problem.bounds)
        for theta in effect.starts:
            p = np.append(base, [theta[q.name] / q.size for q in effect.parameters])
            try:
                r, J = problem.residual(p), problem.jacobian(p, free)
                yield _Start(p=p, chi2=float(r @ r) - LinearModel(J, r, p[free], (low, high)).full_promise)
            except NO_MOTION:
                yield _Start(p=p, chi2=np.inf)


def _as_loud(problem: ExtendedProblem, p: Reals) -> Reals:
    """Return `p` with its unbalance as much larger as the measured 1X motion is than that of `p`.

    What fits best at a stiffness that is off is next to no unbalance at all, and without motion no force law acts.
    """
    pairs = zip((r.measured[1] for r in problem.recordings), problem.model.predict(p, orders=(1,)), strict=True)
    sizes = [[np.linalg.norm((z - z[-1:])[m.usable]) for z in (m.z, one[1])] for m, one in pairs]
    measured, predicted = np.linalg.norm(sizes, axis=0)
    louder = p.copy()
    louder[problem.parameters.base.unbalance] *= measured / predicted if predicted else 1.0
    return louder


def _cluster(starts: Iterator[_Start], effect: Effect) -> list[_Start]:
    """Return the starts that no neighbour is below."""
    every = list(starts)
    chi2 = np.array([start.chi2 for start in every]).reshape([len(q.starts) or 1 for q in effect.parameters])
    lowest = (chi2 == minimum_filter(chi2, size=3, mode="nearest")) & np.isfinite(chi2)
    return [every[i] for i in np.flatnonzero(lowest)]


def _solve(problem: ExtendedProblem, start: Reals, chi2: float, *, pinned: bool = False) -> Solution:
    return problem.solve(
        np.clip(start, *problem.bounds),
        fixed=problem.parameters.pinned if pinned else {},
        tolerance=max(SELECTION.pinned_settled, SELECTION.searched_within * chi2),
        max_steps=SELECTION.searched_steps if pinned else SELECTION.steps_of_searched,
        damped=True,
    )
