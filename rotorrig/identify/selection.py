"""Which causes the data call for: forward by evidence, then backward; each fitted together with the base model.

Evidence is the Bayesian information criterion, BIC = chi2 + k ln n (Schwarz, Annals of Statistics 6 (1978) 461), n the
figures at 1X that are independent: those of neighbouring rows, `STRETCH` of them, are off together. A
cause is taken up if BIC falls by more than `ENOUGH` and chi2 by more than `DETECTED`: no score of eleven simulated
healthy rigs exceeded 10.3; that of a step of unbalance, which is looked for at every moment, was 12.4 at most on ten.
The next is looked for beside it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rotorrig.identify.adequacy import GLOBAL_LIMIT, STRETCH
from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.least_squares import Stop, Worth
from rotorrig.identify.parameters import Reals
from rotorrig.identify.scores import Score, curved_scores, relocated, scores
from rotorrig.identify.solving import Polished
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import Effect, magnitudes

ENOUGH = 4.0  # of BIC
DETECTED = 18.0  # of chi2
MOST = 3  # causes at once
NEAR = 48.0  # of BIC, three times what tells two causes apart: a candidate further behind the best is given up
_FITTED = 8  # candidates that are fitted for every one taken up
_CURVED = 4  # effects without a first order that are fitted, and only as the first cause
_OF_BEST = 3  # of one kind, at other places, if it scores best
_PROMISING = 0.05  # of the best score: a candidate below is not fitted
_SETTLED = 0.1  # of chi2
_DRAWN = 4.0  # sigmas of a prior
_STEPS = 15
_DIRECT = 5  # from a base that is drawn off: a fit that gets there needs no more
_CURVED_STEPS = 6
_RELOCATIONS = 3  # of a scanned effect: the place that suited a wrong base is not yet the right one

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A set of effects, the last of them on trial, and its fit."""

    problem: ExtendedProblem
    polished: Polished
    lam: float  # by how much chi2 is below that without the last effect
    evidence: float  # by how much BIC is

    @property
    def effect(self) -> Effect:
        """The one on trial."""
        return self.problem.effects[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One step forward: what was tried beside the effects that were in already."""

    before: Polished
    scores: tuple[Score, ...]
    tried: tuple[Candidate, ...]  # best first


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """All steps, and the effects kept."""

    start: ExtendedProblem  # the base model, effects of the config included
    base: Polished
    stages: tuple[Stage, ...]
    problem: ExtendedProblem
    polished: Polished


def select(
    problem: ExtendedProblem,
    base: Polished,
    candidates: Sequence[Effect],
    *,
    wrong: bool,
    progress: Progress = lambda stage, share: None,
) -> Selection:
    """Extend the model of `problem`, fitted as `base`, by what its residual calls for; `wrong`: its test failed."""
    stages: list[Stage] = []
    current, polished = problem, base
    for number in range(MOST):
        taken = {own.label for own in current.effects if not own.slight}
        rest = [e for e in candidates if e.label not in taken]
        seen = partial(progress, f"cause {number + 1}")
        stage = _step(current, polished, rest, seen, wrong=wrong, first=not number)
        stages.append(stage)
        if not stage.tried or not called_for(stage.tried[0]):
            break
        best = stage.tried[0]
        current = best.problem
        polished = current.solve(best.polished.p, tolerance=_SETTLED, max_steps=_STEPS)
        if current.curved:
            break  # what a force law leaves is its own harmonics as much as another cause
    if len(current.effects) > len(problem.effects) + 1:
        current, polished = _without_idle(current, polished, kept=len(problem.effects))
    return Selection(start=problem, base=base, stages=tuple(stages), problem=current, polished=polished)


def called_for(candidate: Candidate) -> bool:
    """Say whether the data call for the effect on trial."""
    return candidate.evidence > ENOUGH and candidate.lam > DETECTED


def plausible(candidate: Candidate) -> bool:
    """Say whether the effect on trial is of a size such rigs have; phasors by their magnitude."""
    names = candidate.problem.parameters
    theta = names.of_effect(candidate.polished.p, len(names.effects) - 1)
    sizes = {name: value for name, value, _ in magnitudes(candidate.effect.parameters, theta)}
    return all(
        q.low <= sizes.get(q.name.removesuffix(" re"), theta[q.name]) <= q.high
        for q in candidate.effect.parameters
        if not q.name.endswith(" im")
    )


def _step(
    problem: ExtendedProblem,
    polished: Polished,
    candidates: Sequence[Effect],
    progress: Callable[[float], None],
    *,
    wrong: bool,
    first: bool,
) -> Stage:
    scored = scores(problem, polished.p, candidates)
    if first and (wrong or (scored and scored[0].lam > DETECTED)):
        scored = sorted((*scored, *curved_scores(problem, polished.p, candidates)), key=lambda s: -s.lam)
    promising = _promising(scored)
    late = _unpromising(scored, promising)
    progress(0.3)
    tried: list[Candidate] = []
    for i, score in enumerate((*promising, *late)):
        if i >= len(promising) and any(map(_explained, tried)):
            break
        leader = max((c.evidence for c in tried if plausible(c)), default=-np.inf)
        if (candidate := _tried(problem, polished, score, leader=leader)) is not None:
            tried.append(candidate)
        progress(0.3 + 0.7 * (i + 1) / len((*promising, *late)))
    progress(1.0)
    ranked = sorted(tried, key=lambda c: (not plausible(c), -c.evidence))
    return Stage(before=polished, scores=tuple(scored), tried=tuple(ranked))


def _unpromising(scored: Sequence[Score], promising: Sequence[Score]) -> list[Score]:
    """Return the best of every kind of force law that is not among the promising ones.

    Its score is a guess by the starts it has, about a base that the law has drawn off: where nothing else explains the
    residual, it is fitted all the same.
    """
    found: dict[str, Score] = {}
    taken = {s.effect.name for s in promising}
    for s in scored:
        if s.begin is not None and s.effect.name not in taken:
            found.setdefault(s.effect.name, s)
    return list(found.values())[:_CURVED]


def _explained(candidate: Candidate) -> bool:
    """Say whether with the effect on trial what is left is no more than the noise."""
    return candidate.polished.chi2 <= GLOBAL_LIMIT * candidate.polished.dof


def _promising(scored: Sequence[Score]) -> list[Score]:
    """Return the scores whose causes are fitted: of every kind the best, of the best kind a few."""
    high = [s for s in scored if s.lam > max(DETECTED / 2, _PROMISING * scored[0].lam)]
    kinds: dict[str, int] = {}
    kept, curved = [], 0
    for s in high:
        kinds[s.effect.name] = kinds.get(s.effect.name, 0) + 1
        curved += s.begin is not None
        best_kind = s.effect.name == high[0].effect.name and s.begin is None
        if kinds[s.effect.name] <= (_OF_BEST if best_kind else 1) and (s.begin is None or curved <= _CURVED):
            kept.append(s)
    return kept[:_FITTED]


def _tried(problem: ExtendedProblem, polished: Polished, score: Score, *, leader: float) -> Candidate | None:
    """Fit the effect of a score beside those of `problem`; None where it has no solution.

    It is given up once it could not come near `leader`, the evidence of the best so far, with twice the fall of chi2
    that a full step promises, or ten times under a force law, which bends more.
    """
    cost = _cost(problem, score.effect)
    hoped = 10 if score.effect.curved else 2

    def worth(chi2: float, promise: float) -> bool:
        return polished.chi2 - chi2 + hoped * promise - cost > leader - NEAR

    begun = _nothing(score) if score.begin is None else score.begin
    start = np.concatenate([polished.p, begun])
    hopeful = worth(polished.chi2, score.lam)
    try:
        larger, best = _fitted(problem, score.effect, start, worth=worth, hopeful=hopeful)
        for _ in range(_RELOCATIONS if score.effect.scan and best.stop is not Stop.GIVEN_UP else 0):
            moved = relocated(problem, best.p[: len(polished.p)], score.effect)
            if _same_place(moved, larger.effects[-1]):
                break
            larger, best = _fitted(problem, moved, best.p, worth=worth, hopeful=hopeful)
    except (DataError, np.linalg.LinAlgError):
        return None  # no motion is found, or none that is finite
    lam = polished.chi2 - best.chi2
    best = replace(best, jacobian=np.zeros((0, len(best.p))))  # some 15 MB that nobody asks for again
    return Candidate(problem=larger, polished=best, lam=lam, evidence=lam - cost)


def _fitted(
    problem: ExtendedProblem, effect: Effect, start: Reals, *, worth: Worth, hopeful: bool
) -> tuple[ExtendedProblem, Polished]:
    larger = problem.extended((*problem.effects, effect))
    return larger, _refined(larger, np.clip(start, *larger.bounds), worth=worth, hopeful=hopeful)


def _same_place(effect: Effect, other: Effect) -> bool:
    """Say whether two of a scanned effect stand within a standard deviation of the place: within 1 of chi2."""
    pairs = zip(effect.parameters, other.parameters, strict=True)
    return all(abs(a.nothing - b.nothing) <= a.spread for a, b in pairs if a.scanned)


def _refined(problem: ExtendedProblem, start: Reals, *, worth: Worth, hopeful: bool) -> Polished:
    """Fit from `start`; where that gets stuck as a wrong base has drawn its nuisances off, from their priors instead.

    From far off a nuisance finds back only slowly: in its valley every other unknown has to move with it.
    """
    names = problem.parameters
    drawn = np.abs(names.prior_residual(start)).max(initial=0.0) > _DRAWN
    held = {int(i): 0.0 for i in names.priors if i not in names.linear_nuisances and i < names.own.start}
    if problem.curved:
        if drawn:
            near = problem.solve(start, fixed=held, tolerance=1.0, max_steps=_STEPS, worth=worth)
            if near.stop is Stop.GIVEN_UP:
                return near
            start = near.p
        return problem.solve(start, tolerance=_SETTLED, max_steps=_CURVED_STEPS, worth=worth)
    tried = drawn and hopeful
    direct = problem.solve(start, tolerance=_SETTLED, max_steps=_DIRECT if tried else _STEPS, worth=worth)
    if not tried or direct.stop in (Stop.CONVERGED, Stop.GIVEN_UP):
        return direct
    begun = problem.solve(start, fixed=held, tolerance=1.0, max_steps=_STEPS).p
    anew = problem.solve(begun, tolerance=_SETTLED, max_steps=_STEPS, worth=worth)
    return min(anew, direct, key=lambda fit: fit.chi2)


def _most_steps(problem: ExtendedProblem) -> int:
    return _CURVED_STEPS if problem.curved else _STEPS


def _cost(problem: ExtendedProblem, effect: Effect) -> float:
    """Return what BIC asks for the unknowns of an effect."""
    independent = sum(recording.measured[1].size for recording in problem.recordings) / STRETCH
    return sum(q.low < q.high for q in effect.parameters) * float(np.log(independent))


def _nothing(score: Score) -> Reals:
    """Return the unknowns of its effect where that does nothing: the first full step goes as far as the score says."""
    return np.array([q.nothing / q.size for q in score.effect.parameters])


def _without_idle(problem: ExtendedProblem, polished: Polished, *, kept: int) -> tuple[ExtendedProblem, Polished]:
    """Leave out every effect but the first `kept` and the last without which BIC does not rise by `ENOUGH`."""
    for effect in problem.effects[kept:-1]:
        rest = tuple(e for e in problem.effects if e is not effect)
        smaller = problem.extended(rest)
        columns = np.concatenate(
            [
                np.arange(problem.parameters.own.start),
                *(
                    np.arange(part.start, part.stop)
                    for e, part in zip(problem.effects, problem.parameters.theta, strict=True)
                    if e is not effect
                ),
            ]
        )
        fit = smaller.solve(polished.p[columns], tolerance=_SETTLED, max_steps=_most_steps(smaller))
        if fit.chi2 - polished.chi2 < _cost(problem, effect) + ENOUGH:
            return _without_idle(smaller, fit, kept=kept)
    return problem, polished
