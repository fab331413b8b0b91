"""Discovery of a missing force: searched, fitted with the base, and measured on data that no fit saw."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.identify.base_fit import AssessedFit, assess_fit
from rotorrig.identify.causes import Candidate, Selection, SelectionStep, refit, relocate_last_effect
from rotorrig.identify.discovery.force_search import grid, search_force
from rotorrig.identify.discovery.missing_force import MissingForce, leaves_too_much, missing_force, shortfall
from rotorrig.identify.discovery.place_probability import move_to_best_place
from rotorrig.identify.verdict import Predictions, Unseen, predict_unseen
from rotorrig.rig import DataError
from rotorrig.sims.effects import LAWS


@dataclass(frozen=True, slots=True, kw_only=True)
class Discovery:
    """A missing force, the model with it, and how well that predicts."""

    missing: MissingForce
    selection: Selection
    extended: AssessedFit
    predictions: Predictions


def discover(
    start: AssessedFit, before: Selection, unseen: Unseen, go_on: Callable[[], bool] = lambda: True
) -> Discovery | None:
    """Look for the force that the model of `start` lacks; None if no law explains anything.

    `before` is the selection of known causes for that model, which explain less than they should.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # steps of a fit that are not taken
        tried = search_force(start.problem, start.polished, go_on)
        for i in range(len(tried)):
            try:
                return _measure(start, before, unseen, tried[i:], go_on)
            except (DataError, np.linalg.LinAlgError):
                continue  # no motion is found under it to the end, or none that is finite
    return None


def _measure(
    start: AssessedFit, before: Selection, unseen: Unseen, tried: Sequence[Candidate], go_on: Callable[[], bool]
) -> Discovery:
    """Return the first of `tried` in its final fit, with what it predicts. Raises DataError, LinAlgError.

    How probable other places are is found out only if it may count as found: it takes longer than all else.
    """
    rig, polished = start.problem.recordings[0].rig, refit(tried[0].problem, tried[0].polished.p)
    best = replace(tried[0], polished=polished)
    may_count = not leaves_too_much(start.polished, best, assess_fit(best.problem, polished).adequacy)
    best, profile = move_to_best_place(best, grid(rig), profiled=may_count)
    _, fit = relocate_last_effect(best.problem, best.polished)
    scores = before.steps[0].scores if before.steps else ()
    step = SelectionStep(before=start.polished, scores=scores, tried=tuple(tried))
    selection = replace(before, steps=(step, *before.steps), problem=best.problem, polished=fit)
    extended = assess_fit(best.problem, fit)
    predictions = predict_unseen(selection, unseen, adequate=False)
    found, missing = replace(best, polished=fit), missing_force(start.problem, tried, fit, profile, profiled=may_count)
    tries = max(len(LAWS) * len(missing.places), 1)
    short = shortfall(start.polished, found, missing, extended.adequacy, predictions, tries=tries)
    if not go_on():
        short = "it was not looked for to the end"
    return Discovery(
        missing=replace(missing, shortfall=short), selection=selection, extended=extended, predictions=predictions
    )
