"""One step of forward selection: score all candidates beside those a model has, and fit the promising ones.

What scores high is fitted, one by one; where the misfit has taken the base far off, causes are searched from the
nameplate as well. Force laws and pedestals have no score of the first order: they are always searched from there, and
where an unmodelled cause has biased the base, or is loud, only if nothing else explains it or promises to: what is
faint may be explained by another that is like it, what is loud not down to the noise.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from rotorrig.identify.causes.candidate_fit import (
    Candidate,
    describes_data,
    finish,
    fit_candidate,
    plausible,
    tolerance,
)
from rotorrig.identify.causes.nameplate_search import rescore_from_nameplate, search_from_nameplate
from rotorrig.identify.causes.pinned_nuisances import fit_with_pinned_nuisances, nuisances_biased
from rotorrig.identify.causes.score_test import Score, scores
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution, Stop
from rotorrig.sims.effects import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionStep:
    """One step of forward selection: the candidates fitted beside the effects of the model so far."""

    before: Solution
    scores: tuple[Score, ...]
    tried: tuple[Candidate, ...]  # best first

    def chose(self, effect: Effect, *, beside: Sequence[Effect]) -> bool:
        """Say whether `effect` was the best here, beside just the effects of `beside`."""
        best = self.tried[0] if self.tried else None
        return best is not None and best.effect is effect and _labels(best.problem.effects[:-1]) == _labels(beside)


def try_candidates(
    problem: ExtendedProblem,
    polished: Solution,
    candidates: Sequence[Effect],
    progress: Callable[[float], None],
    *,
    wrong: bool,
    first: bool,
    needed: float = SELECTION.detected,
    go_on: Callable[[], bool] = lambda: True,
) -> SelectionStep:
    """Fit what scores high; where the misfit is loud or biases the base, force laws only if nothing else explains it.

    What scores less than half of the fall of chi2 that is `needed` is not fitted. Once `go_on` says no, nothing more
    is.
    """
    scored = scores(problem, polished.p, candidates)
    excess = _excess(problem, polished)
    biased = nuisances_biased(problem, polished.p)
    astray = biased and excess > _values(problem)
    if first and astray and not _best_reaches(scored, excess):
        scored = rescore_from_nameplate(problem, polished, scored, go_on=go_on)
    searched = first and (wrong or (bool(scored) and scored[0].lam > SELECTION.detected))
    by_score = _best_reaches(scored, excess)
    later = by_score and (biased or excess > SELECTION.loud)
    search = partial(search_from_nameplate, problem, polished, candidates, biased=wrong and astray, go_on=go_on)
    laws = search() if searched and not later else []
    choose = partial(_promising, needed=needed, excess=excess)
    promising = choose(sorted((*scored, *laws), key=lambda s: -s.lam))
    progress(0.3)
    plain = fit_with_pinned_nuisances(problem, polished.p) if astray and (promising or searched) else None
    fit_all = partial(_fit_all, problem, polished, plain, go_on=go_on)
    tried = fit_all(promising, (), progress=lambda share: progress(0.3 + 0.5 * share))
    if searched and not any(_explains(candidate, excess) for candidate in tried):
        laws = search() if later else laws
        late = [s for s in choose(laws if later else scored) if s not in promising]
        tried = fit_all(late, tried, progress=lambda share: progress(0.8 + 0.2 * share))
    if go_on():
        tried = _finish_near(tried, tolerance(polished))
    if go_on() and not any(_explains(candidate, excess) for candidate in tried):
        tried = _finish_rivals(tried)
    progress(1.0)
    ranked = sorted(tried, key=lambda c: (not plausible(c), -c.evidence))
    return SelectionStep(before=polished, scores=(*scored, *laws), tried=tuple(ranked))


def _excess(problem: ExtendedProblem, polished: Solution) -> float:
    """Return by how much chi2 of 1X is more than adequate, priors included; negative where it is less."""
    r = problem.residual(polished.p, orders=(1,))
    return float(r @ r) - _values(problem)


def _values(problem: ExtendedProblem) -> int:
    """Return the number of values at 1X: with twice their chi2, or more, a base is far off."""
    return sum(recording.measured[1].size for recording in problem.recordings)


def _fit_all(
    problem: ExtendedProblem,
    polished: Solution,
    plain: Solution | None,
    scored: Sequence[Score],
    before: Sequence[Candidate],
    *,
    progress: Callable[[float], None],
    go_on: Callable[[], bool],
) -> list[Candidate]:
    """Return the candidates of `before` and after them those of the scores, each up against the best so far."""
    tried = list(before)
    for i, score in enumerate(scored):
        if not go_on():
            break
        leader = max((c.evidence for c in tried if plausible(c)), default=-np.inf)
        if (candidate := fit_candidate(problem, polished, plain, score, leader=leader, go_on=go_on)) is not None:
            _keep_better(tried, candidate)
        progress((i + 1) / len(scored))
    return tried


def _finish_near(tried: Sequence[Candidate], rough: float) -> list[Candidate]:
    """Fit to its end what came to the end of its steps near the best: it may be tied with that, or better.

    So is what was fitted to so much of chi2 that its order is open, unless the best leaves too much for that to matter.
    """
    best = max((c for c in tried if plausible(c)), key=lambda c: c.evidence, default=None)
    if best is None:
        return list(tried)
    settled = (Stop.CONVERGED, Stop.STALLED)
    ends = (Stop.BUDGET, *settled) if rough > SELECTION.settled and describes_data(best.polished) else (Stop.BUDGET,)
    least = best.evidence - SELECTION.near - rough
    return [finish(c) if c.polished.stop in ends and c.evidence > least else c for c in tried]


def _finish_rivals(tried: Sequence[Candidate]) -> list[Candidate]:
    """Fit to its end what was given up not far behind the best.

    What a full step promises says little in a narrow, bent valley: a fit that was given up by it may be the one that
    explains what the best does not.
    """
    least = SELECTION.rival * max((c.lam for c in tried if plausible(c)), default=np.inf)
    return [finish(c) if c.polished.stop is Stop.GIVEN_UP and c.lam > least else c for c in tried]


def _keep_better(tried: list[Candidate], candidate: Candidate) -> None:
    """Add a candidate; of two fits with the same label the better one stays."""
    label = candidate.effect.label
    if all(candidate.polished.chi2 < c.polished.chi2 for c in tried if c.effect.label == label):
        tried[:] = [*(c for c in tried if c.effect.label != label), candidate]


def _explains(candidate: Candidate, excess: float) -> bool:
    """Say whether with the candidate next to nothing is left of the `excess` of chi2 at 1X."""
    left = SELECTION.left_by_law * excess if candidate.effect.needs_starts else 0.0
    return _excess(candidate.problem, candidate.polished) <= left


def _promising(scored: Sequence[Score], *, needed: float, excess: float) -> list[Score]:
    """Return the scores whose causes are fitted: of every kind the best, of the best kind a few.

    Those that score nearly alike come by the number of their unknowns: few of them are soon fitted, and then the long
    fits of the others can be given up; but first comes what scores for nearly all of the `excess`. Where one leads that
    was searched for, only those begun at a small amount, which are soon fitted too, come before it.
    """
    if not scored:
        return []
    law = SELECTION.rival_search * max((s.lam for s in scored if s.begin is not None), default=0.0)
    least = max(needed / 2, SELECTION.promising * scored[0].lam)
    high = [s for s in scored if s.lam > (max(least, law) if s.begins_at_full_amount else least)]
    kinds: dict[str, int] = {}
    kept = []
    for s in high:
        kinds[s.effect.name] = kinds.get(s.effect.name, 0) + 1
        if kinds[s.effect.name] <= (SELECTION.of_best if s.effect.name == high[0].effect.name else 1):
            kept.append(s)
    kept = kept[: SELECTION.fitted]
    if not kept:
        return kept
    if kept[0].begins_at_full_amount:
        return sorted(kept, key=lambda s: s.begin is None or s.begins_at_full_amount)
    if _reaches(kept[0], excess):
        return kept
    rivals = [s for s in kept if s.lam > SELECTION.rival * kept[0].lam]
    return sorted(rivals, key=lambda s: len(s.effect.parameters)) + kept[len(rivals) :]


def _best_reaches(scored: Sequence[Score], excess: float) -> bool:
    return bool(scored) and _reaches(scored[0], excess)


def _reaches(score: Score, excess: float) -> bool:
    """Say whether so little of the excess would be left that the score may be all there is to it."""
    return excess - score.lam < SELECTION.reached * excess


def _labels(effects: Sequence[Effect]) -> set[str]:
    return {effect.label for effect in effects}
