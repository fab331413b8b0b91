"""Stepwise selection of causes: forward by evidence, then backward; each fitted together with the base model.

A cause is taken up if BIC (candidate_fit.py) falls by more than `SELECTION.enough` and chi2 by more than
`SELECTION.detected`; a step of unbalance, which is looked for at every moment, needs more. The next is looked for
beside it, and has to explain more than a small error of that one's model would leave. What was found beside other
causes than it has in the end is then looked for once more: what suited best need not be the cause.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rotorrig.identify.adequacy import ADEQUACY
from rotorrig.identify.causes.candidate_fit import Candidate, describes_data, price, refit, relocate_last_effect
from rotorrig.identify.causes.selection_step import SelectionStep, try_candidates
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution
from rotorrig.rig import DataError
from rotorrig.sims.effects import Effect

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """All steps, and the effects kept."""

    start: ExtendedProblem  # the base model, effects of the config included
    base: Solution
    steps: tuple[SelectionStep, ...]
    problem: ExtendedProblem
    polished: Solution

    def without_causes(self) -> "Selection":
        """Return the same with none of them kept."""
        return replace(self, problem=self.start, polished=self.base)

    def with_law_error(self) -> "Selection":
        """Return the same with what its force law may be wrong by in the covariance, refitted; itself without a law.

        What a law that is a little wrong leaves is else taken up by the nameplate and the rotor. Itself, too, where no
        bounded motion is found on the way.
        """
        if not self.problem.model.moving(self.polished.p).laws:
            return self
        problem = self.problem.expecting_error(self.polished.p)
        try:
            return replace(self, problem=problem, polished=refit(problem, self.polished.p))
        except (DataError, np.linalg.LinAlgError):
            return self


def select(
    problem: ExtendedProblem,
    base: Solution,
    candidates: Sequence[Effect],
    *,
    wrong: bool,
    progress: Progress = lambda stage, share: None,
    go_on: Callable[[], bool] = lambda: True,
) -> Selection:
    """Extend the model of `problem`, fitted as `base`, by what its residual supports; `wrong`: its test failed.

    Once `go_on` says no, it is extended by what has been found. If the base itself fits better from where the first
    cause has led it, it is that base, and nothing else, that is returned: the search is to begin anew from there.
    """
    steps: list[SelectionStep] = []
    current, polished = problem, base

    def search(what: str, problem: ExtendedProblem, polished: Solution, among: Sequence[Effect]) -> SelectionStep:
        taken = {own.label for own in problem.effects if not own.is_nuisance}
        rest = [e for e in among if e.label not in taken]
        needed = _require_fall(base.chi2 - polished.chi2)
        return try_candidates(
            problem, polished, rest, partial(progress, what), wrong=wrong, first=not steps, needed=needed, go_on=go_on
        )

    for number in range(SELECTION.most):
        step = search(f"cause {number + 1}", current, polished, candidates)
        steps.append(step)
        if not step.tried or not is_significant(step.tried[0], explained=base.chi2 - polished.chi2):
            break
        if number == 0 and (lower := _find_lower_base(base, step.tried[0])):
            return Selection(start=problem, base=lower, steps=(), problem=problem, polished=lower)
        current, polished = _with_error_of_effects(*_refit_best(steps))
        if current.curved:
            break  # what a force law leaves is its own harmonics as much as another cause
        if not go_on():
            break
    kept = len(problem.effects)
    if len(current.effects) > kept + 1:
        current, polished = _drop_idle(current, polished, kept=kept)
    if go_on() and len(steps) > 1 and not current.curved and len(current.effects) > kept:
        again = _search_again(current, polished, partial(search, "causes again"), candidates, steps, kept=kept)
        current, polished = again if again[0] is current else _drop_idle(*again, kept=kept)
    return Selection(start=problem, base=base, steps=tuple(steps), problem=current, polished=polished)


def _find_lower_base(base: Solution, best: Candidate) -> Solution | None:
    """Return the fit without a cause from where the fit with it ended, if that is lower than the fit of the base.

    A search that ended in a minimum of its own is left by any cause, and what leads out of it need not be there. A
    cause that describes the data where the base does not even so is, and so is one by which chi2 falls by more than
    twice what the base alone falls by: nothing is to be searched from there. Nor is it where a base was poor and is
    lower by no more than it may have ended short of its own minimum.
    """
    open_end = 0.0 if describes_data(base) else SELECTION.open_end * base.chi2
    by_cause = SELECTION.by_base * (base.chi2 - best.polished.chi2)
    _, fit = leave_out(best.problem, best.polished, [best.effect])
    if describes_data(best.polished) and not describes_data(fit):
        return None
    return fit if fit.chi2 < base.chi2 - max(SELECTION.detected, open_end, by_cause) else None


def is_significant(candidate: Candidate, *, explained: float = 0.0) -> bool:
    """Say whether the data support the candidate beside causes that have explained so much of chi2."""
    needed = _require_fall(explained) + _search_penalty(candidate)
    return candidate.evidence > SELECTION.enough and candidate.lam > needed


def _require_fall(explained: float) -> float:
    """Return by how much chi2 has to fall, beside causes that have explained so much of it."""
    return SELECTION.detected + SELECTION.model_error**2 * max(explained, 0.0)


def _search_penalty(candidate: Candidate) -> float:
    """Return by how much more chi2 has to fall after a grid search: the best of n locations gains 2 ln n by chance.

    Neighbouring rows, `ADEQUACY.stretch` of them, make one place.
    """
    if not candidate.effect.grid:
        return 0.0
    return 2 * float(np.log(sum(len(recording.rows) for recording in candidate.problem.recordings) / ADEQUACY.stretch))


def _search_again(
    problem: ExtendedProblem,
    polished: Solution,
    search: Callable[[ExtendedProblem, Solution, Sequence[Effect]], SelectionStep],
    candidates: Sequence[Effect],
    steps: list[SelectionStep],
    *,
    kept: int,
) -> tuple[ExtendedProblem, Solution]:
    """Search once more for causes found beside others than those they have now, and for one in place of two.

    Two of one kind may be parts of a third, as the delays of both planes are of one of all probes. What BIC likes
    better takes the place, of what it likes as well what was there stays; what was tried is added to `steps`.
    """
    for leaving in _in_question(problem.effects[kept:]):
        others = [e for e in problem.effects if e not in leaving]
        if len(others) + len(leaving) > len(problem.effects):
            continue  # one of them has been replaced
        if len(leaving) == 1 and any(step.chose(leaving[0], beside=others) for step in steps):
            continue
        if len(leaving) > 1:
            among = [e for e in candidates if e.name == leaving[0].name]
        else:
            among = _rivals(leaving[0], others, candidates, steps, polished)
        if not among:
            continue
        step = search(*leave_out(problem, polished, leaving), among)
        best = step.tried[0] if step.tried else None
        now = polished.chi2 + sum(price(problem, effect) for effect in leaving)
        if best is None:
            continue
        stays = best.effect.label in {effect.label for effect in leaving}
        margin = SELECTION.as_good if stays else -SELECTION.as_good
        if best.polished.chi2 + price(problem, best.effect) > now + margin:
            continue
        steps.append(step)
        problem, polished = _refit_best(steps)
    return problem, polished


def _rivals(
    effect: Effect,
    others: Sequence[Effect],
    candidates: Sequence[Effect],
    steps: Sequence[SelectionStep],
    polished: Solution,
) -> list[Effect]:
    """Return what could take the place of a cause beside `others`: what came near when it was chosen beside fewer.

    Near is what was behind by no more than `SELECTION.near` and twice what those found since have explained. All may
    where it was chosen beside what has left, or in no step, and where the fit does not describe the data.
    """
    chosen = next((step.tried for step in steps if step.tried and step.tried[0].effect.label == effect.label), ())
    stayed = {e.label for e in others}
    comparable = bool(chosen) and stayed.issuperset(e.label for e in chosen[0].problem.effects[:-1])
    if not comparable or not describes_data(polished):
        return list(candidates)
    least = chosen[0].evidence - SELECTION.near - 2 * max(chosen[0].polished.chi2 - polished.chi2, 0.0)
    near = {c.effect.label for c in chosen[1:] if c.evidence > least}
    return [e for e in candidates if e.label in near - stayed]


def _with_error_of_effects(problem: ExtendedProblem, fit: Solution) -> tuple[ExtendedProblem, Solution]:
    """Return a fit with what its effects may be wrong by in the covariance; itself where that is nothing."""
    if not any(problem.error_of_effects(fit.p)):
        return problem, fit
    expecting = problem.expecting_error(fit.p)
    return expecting, refit(expecting, fit.p)


def _refit_best(steps: list[SelectionStep]) -> tuple[ExtendedProblem, Solution]:
    """Fit the best of the last step to convergence; update the step where that relocates it."""
    best, *others = steps[-1].tried
    problem, fit = relocate_last_effect(best.problem, refit(best.problem, best.polished.p))
    if problem is not best.problem:
        rest = (c for c in others if c.effect.label != problem.effects[-1].label)
        steps[-1] = replace(steps[-1], tried=(replace(best, problem=problem), *rest))
    return problem, fit


def _in_question(chosen: Sequence[Effect]) -> list[list[Effect]]:
    """Return the sets to leave out in turn: all effects of one kind, where there are several, then every single one."""
    kinds = [[e for e in chosen if e.name == name] for name in dict.fromkeys(e.name for e in chosen)]
    return [*(kind for kind in kinds if len(kind) > 1), *([effect] for effect in chosen)]


def _drop_idle(problem: ExtendedProblem, polished: Solution, *, kept: int) -> tuple[ExtendedProblem, Solution]:
    """Leave out every effect but the first `kept` and the last without which BIC does not rise by enough."""
    for effect in problem.effects[kept:-1]:
        smaller, fit = leave_out(problem, polished, [effect])
        if fit.chi2 - polished.chi2 < price(problem, effect) + SELECTION.enough:
            return _drop_idle(smaller, fit, kept=kept)
    return problem, polished


def leave_out(
    problem: ExtendedProblem, polished: Solution, leaving: Sequence[Effect]
) -> tuple[ExtendedProblem, Solution]:
    """Refit the problem without some of its effects; from none of them, where what is left has no motion."""
    smaller = problem.extended([e for e in problem.effects if e not in leaving])
    parts = zip(problem.effects, problem.parameters.theta, strict=True)
    others = [np.arange(part.start, part.stop) for e, part in parts if e not in leaving]
    start = polished.p[np.concatenate([np.arange(problem.parameters.own.start), *others])]
    try:
        return smaller, refit(smaller, start)
    except DataError:
        return smaller, refit(smaller, smaller.parameters.start(start))
