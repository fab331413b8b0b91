"""Search for causes that no score of the first order finds, from the nameplate and not from a base that they biased.

The unknowns of an effect are searched together with the base's stiffness, damping and unbalance, on some rows of the
first recording, their speed taken as steady, in three stages. Gather: at each of the effect's starts, where a full step
of all these unknowns would lead. Cluster: the lowest few of them that are apart. Descend: from each, with nuisances
pinned at their priors; the lowest then with every unknown free. It begins at the nameplate and at the base's fit. What
promises most descends first, and what could not come near it is given up.

Those that are linear while small are scored for that as well: small_amounts.py. Those that have a first order are
searched for where the base is far off: `rescore_from_nameplate`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import minimum_filter

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes.score_test import Score
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.small_amounts import NO_MOTION, score_small_amounts
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Index, LinearModel, Solution, Stop, Worth, always
from rotorrig.sims.effects import Effect


def search_from_nameplate(
    problem: ExtendedProblem,
    polished: Solution,
    candidates: Sequence[Effect],
    *,
    biased: bool,
    go_on: Callable[[], bool] = lambda: True,
) -> list[Score]:
    """Score effects that need starts, beside those of `problem`, whose fit is `polished`, while `go_on`; best first.

    The score is the share of chi2 that the candidate takes on those rows, of the chi2 of `polished`. If that is not
    `biased`, which what is adequate cannot be by much, it is where the search begins, and not at the nameplate too.
    """
    able = [effect for effect in candidates if effect.needs_starts]
    scores = _search_all(problem, polished, able, biased=biased, go_on=go_on) if able else []
    scores += score_small_amounts(problem, polished.p, able) if able and go_on() else []
    return sorted(scores, key=lambda score: -score.lam)


def rescore_from_nameplate(
    problem: ExtendedProblem,
    polished: Solution,
    scored: Sequence[Score],
    *,
    go_on: Callable[[], bool] = lambda: True,
) -> list[Score]:
    """Return the scores of effects that have a first order, the best of every kind searched from the nameplate too.

    Of a base that its cause has taken far off, to another minimum, the first order misleads. What the search finds a
    higher score for begins where it has led; best first. What acts in one recording, or from a moment on, is left out:
    the rows searched are of the first recording.
    """
    best: dict[str, Effect] = {}
    for score in scored:
        if not score.effect.grid and score.effect.recording is None:
            best.setdefault(score.effect.name, score.effect)
    found = _search_all(problem, polished, list(best.values()), biased=True, go_on=go_on) if best else []
    searched = {f.effect.label: f for f in found}
    both = [(score, searched.get(score.effect.label, score)) for score in scored]
    better = [replace(f, visible=s.visible) if f.lam > s.lam else s for s, f in both]
    return sorted(better, key=lambda score: -score.lam)


def _search_all(
    problem: ExtendedProblem,
    polished: Solution,
    able: Sequence[Effect],
    *,
    biased: bool,
    go_on: Callable[[], bool],
) -> list[Score]:
    """Search for every effect; a score, and where a fit to all recordings is to begin, of each that came near."""
    search = _Search.of(problem, polished.p, biased=biased)
    gathered = [(effect, search.gather(effect)) for effect in able if go_on()]
    scores: list[Score] = []
    lowest = search.pinned_chi2
    descended: list[tuple[Effect, Solution]] = []
    for effect, starts in sorted(gathered, key=lambda each: min((s.chi2 for s in each[1]), default=np.inf)):
        if go_on() and (near := search.descend(effect, starts, lowest=lowest)) is not None:
            lowest = min(lowest, near.chi2)
            descended.append((effect, near))
    for effect, near in descended:
        if not go_on() or near.chi2 > search.limit_rivals(lowest):
            continue
        fit = search.free(effect, near)
        begin = np.append(polished.p, fit.p[len(search.index) :])
        begin[search.index] = fit.p[: len(search.index)]
        lam = polished.chi2 * (1 - fit.chi2 / search.chi2)
        scores.append(Score(effect=effect, lam=lam, step=np.zeros(0), visible=0.0, begin=begin))
    return scores


@dataclass(frozen=True, slots=True, kw_only=True)
class _Start:
    """A start of an effect beside a base, and where a full step from there would lead."""

    p: Reals
    chi2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search:
    """The rows searched, and the base there."""

    problem: ExtendedProblem
    marginal: ExtendedProblem  # the same with what nuisances do in its covariance, for fits with these pinned
    index: Index  # of its unknowns in those of the whole problem
    bases: tuple[Reals, ...]  # where it begins: at the base's fit, and at the nameplate too if that may be biased
    chi2: float  # of the base
    pinned_chi2: float  # of the base with nuisances pinned

    @classmethod
    def of(cls, whole: ExtendedProblem, p: Reals, *, biased: bool) -> "_Search":
        problem, index = whole.thinned(p, count=SELECTION.searched_rows)
        problem, marginal = (problem.expecting_error(p[index], pinned=pinned) for pinned in (False, True))
        names = problem.parameters
        nameplate = _as_loud(problem, problem.begin(names.base.space.nameplate, p[index][names.own]))
        near = _solve(marginal, p[index], 0.0, pinned=True)
        base = min((_solve(problem, start, 0.0) for start in (near.p, p[index])), key=lambda fit: fit.chi2)
        bases = (nameplate, near.p) if biased else (near.p,)
        return cls(problem=problem, marginal=marginal, index=index, bases=bases, chi2=base.chi2, pinned_chi2=near.chi2)

    def gather(self, effect: Effect) -> list[_Start]:
        """Return the lowest starts of an effect that are apart, the best first."""
        problem = self.marginal.extended((*self.problem.effects, effect))
        clusters = [start for base in self.bases for start in _cluster(self._starts(problem, base, effect), effect)]
        return sorted(clusters, key=lambda start: start.chi2)[: SELECTION.descents]

    def limit_rivals(self, lowest: float) -> float:
        """Return the chi2 with pinned nuisances up to which a fit is near `lowest`, the best of them."""
        return self.pinned_chi2 - SELECTION.rival_search * (self.pinned_chi2 - lowest)

    def descend(self, effect: Effect, starts: Sequence[_Start], *, lowest: float) -> Solution | None:
        """Return the lowest fit of an effect from its starts with nuisances pinned; None if none is left.

        One that could not come near `lowest`, the best such fit of any effect, is given up, and one that could not come
        below that from a start before.
        """
        problem = self.marginal.extended((*self.problem.effects, effect))
        needed = self.limit_rivals(lowest)
        ends: list[Solution] = []
        for start in starts:
            target = min([needed, *(fit.chi2 for fit in ends)])

            def worth(chi2: float, promise: float, target: float = target) -> bool:
                return chi2 - SELECTION.promised_by_law * promise < target

            try:
                ends.append(_solve(problem, start.p, start.chi2, pinned=True, worth=worth))
            except NO_MOTION:
                continue
        return min((fit for fit in ends if fit.stop is not Stop.GIVEN_UP), key=lambda fit: fit.chi2, default=None)

    def free(self, effect: Effect, near: Solution) -> Solution:
        """Return the fit with every unknown free, never given up: what pinned nuisances spoil promises nothing."""
        problem = self.problem.extended((*self.problem.effects, effect))
        try:
            return _solve(problem, near.p, 0.0)
        except NO_MOTION:
            return near

    def _starts(self, problem: ExtendedProblem, base: Reals, effect: Effect) -> Iterator[_Start]:
        """Yield every start of the effect beside a base, and where a full step from there leads."""
        names = problem.parameters
        free = np.setdiff1d(np.arange(len(names)), [*names.pinned, *names.frozen])
        low, high = (bound[free] for bound in problem.bounds)
        bare = self.marginal.residual(base)
        for theta in effect.starts:
            p, chi2 = np.append(base, [theta[q.name] / q.size for q in effect.parameters]), np.inf
            try:
                r = problem.residual(p)
                moved = np.abs(r - bare).max() > SELECTION.no_change
                if moved or not effect.needs_starts:  # a wall out of reach leads nowhere
                    J = problem.jacobian(p, free)
                    chi2 = float(r @ r) - LinearModel(J, r, p[free], (low, high)).full_promise
            except NO_MOTION:
                pass
            yield _Start(p=p, chi2=chi2)


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


def _solve(
    problem: ExtendedProblem, start: Reals, chi2: float, *, pinned: bool = False, worth: Worth = always
) -> Solution:
    return problem.solve(
        np.clip(start, *problem.bounds),
        fixed=problem.parameters.pinned if pinned else {},
        tolerance=max(SELECTION.pinned_settled, SELECTION.searched_within * chi2),
        share=0.0 if pinned else SELECTION.searched_within,
        max_steps=SELECTION.searched_steps if pinned else SELECTION.steps_of_searched,
        worth=worth,
        damped=True,
    )
