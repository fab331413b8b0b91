"""What a cause buys on unseen data, and what the choice of it does."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.causes.candidate_fit import Candidate
from rotorrig.identify.causes.selection_step import SelectionStep
from rotorrig.identify.causes.stepwise_selection import Selection
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.cross_validation import Fold, Prediction, Unseen, pool_folds
from rotorrig.identify.verdict.gain import Predictions, choose_again, leave_out_excess, leave_out_idle, predict_unseen
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response
from tests.parameters import defer_rest


def model(shown: tuple[float, ...], hidden: tuple[float, ...]) -> Prediction:
    """A model's chi2 of the rows each fit was shown, and its squared error in those hidden from it, in four blocks."""
    folds = []
    for number, (seen, unseen) in enumerate(zip(shown, hidden, strict=True)):
        blocks = np.zeros(12)
        blocks[number::3] = unseen / 4
        errors = np.array([unseen * 1e-12, 40e-12, 0.0, unseen, 20.0])
        folds.append(Fold(shown=seen, errors=errors, blocks=blocks))
    return pool_folds(folds)


BASE = model((900.0, 910.0, 905.0), (450.0, 460.0, 455.0))
CAUSE = model((700.0, 705.0, 710.0), (350.0, 352.0, 356.0))


def test_every_fit_takes_the_model_that_suits_the_rows_it_was_shown() -> None:
    first_only = model((650.0, 720.0, 730.0), (360.0, 990.0, 990.0))
    again = choose_again([(0.0, BASE), (10.0, CAUSE), (10.0, first_only)])
    assert again.blocks.sum() == pytest.approx(360 + 352 + 356)
    assert again.blocks.tolist() == pytest.approx([90.0, 88.0, 89.0] * 4)


def test_unknowns_have_their_price_in_every_fold() -> None:
    assert choose_again([(0.0, BASE), (190.0, CAUSE)]).blocks.sum() == pytest.approx(350 + 352 + 356)
    assert choose_again([(0.0, BASE), (196.0, CAUSE)]).blocks.sum() == pytest.approx(350 + 352 + 455)
    assert choose_again([(0.0, BASE), (206.0, CAUSE)]).blocks.sum() == pytest.approx(450 + 460 + 455)


def test_a_cause_that_fits_all_rows_but_is_another_in_each_part_of_them_has_gained_nothing() -> None:
    chance = [
        model(tuple(700.0 if fold == own else 890.0 for fold in range(3)), (470.0, 470.0, 470.0)) for own in range(3)
    ]
    again = choose_again([(0.0, BASE), *((10.0, found) for found in chance)])
    found = Predictions(before=BASE, after=CAUSE, by_label={}, on="blocks")
    assert found.better
    assert not Predictions(before=BASE, after=CAUSE, by_label={}, chosen_again=again, on="blocks").better


BOW, STEP, DELAY = "bow", "unbalance_step", "delay, probe 2y"


def selection(rig: RigConfig, hidden: np.ndarray, there: tuple[str, ...], taken: tuple[str, ...]) -> Selection:
    """Causes taken up by a fit to a recording in which these are."""
    effects = {label: find(rig, label) for label in (*there, *taken)}
    recording = swept_response(
        rig,
        rng=np.random.default_rng(4),
        hidden=[
            (effects[label], {q.name: q.at_zero + 1.5 * q.size for q in effects[label].parameters}) for label in there
        ],
    )
    start = ExtendedProblem(ExtendedModel([Recording(recording)]))
    base = start.solve(start.parameters.start(hidden))
    problem = start.extended([effects[label] for label in taken])
    polished = problem.solve(problem.parameters.start(hidden))
    return Selection(start=start, base=base, steps=(), problem=problem, polished=polished)


@pytest.mark.parametrize(
    ("there", "taken", "kept"),
    defer_rest(
        [
            ((BOW,), (DELAY, BOW), [BOW]),
            ((BOW,), (BOW, DELAY), [BOW]),
            ((BOW, DELAY), (BOW, DELAY), [BOW, DELAY]),
            ((BOW,), (STEP, BOW, DELAY), [BOW]),
            ((), (DELAY,), [DELAY]),  # a single one is for the verdict
        ]
    ),
)
def test_every_one_of_several_causes_has_to_predict_what_no_fit_saw(
    rig: RigConfig, hidden: np.ndarray, there: tuple[str, ...], taken: tuple[str, ...], kept: list[str]
) -> None:
    found = selection(rig, hidden, there, taken)
    left = leave_out_idle(found, Unseen(found.start, found.base.p))
    assert [effect.label for effect in left.problem.effects] == kept
    assert len(left.polished.p) == len(found.polished.p) - sum(
        len(e.parameters) for e in found.problem.effects if e.label not in kept
    )


def test_of_too_many_causes_that_of_least_evidence_goes(rig: RigConfig, hidden: np.ndarray) -> None:
    found = selection(rig, hidden, (BOW,), (DELAY, BOW))
    assert leave_out_excess(found, lambda _: 1).problem is found.problem
    assert [e.label for e in leave_out_excess(found, lambda _: 2).problem.effects] == [BOW]
    assert not leave_out_excess(found, lambda _: 4).problem.effects


def test_what_was_chosen_predicts_as_it_was_fitted_in_the_end(rig: RigConfig, hidden: np.ndarray) -> None:
    """Under a force law a candidate is ranked long before its fit is done."""
    found = selection(rig, hidden, (BOW,), (BOW,))
    halfway = replace(found.polished, p=found.polished.p + 3 * np.nan_to_num(found.polished.sigma, posinf=0.0))
    ranked = Candidate(problem=found.problem, polished=halfway, lam=900.0, evidence=890.0)
    step = SelectionStep(before=found.base, scores=(), tried=(ranked,))
    unseen = Unseen(found.start, found.base.p)
    predicted = predict_unseen(replace(found, steps=(step,)), unseen, adequate=True)
    assert predicted.after is predicted.by_label[BOW][1]
    assert predicted.after.error == unseen.measure(found.problem, found.polished.p).error
    assert predicted.agreement is not None
    too_much = predict_unseen(replace(found, steps=(step,)), unseen, adequate=True, misstated=3)
    assert too_much.agreement is None and too_much.after.error == predicted.after.error
