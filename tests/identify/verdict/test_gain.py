"""What a cause buys on unseen data, and what the choice of it does."""

import numpy as np
import pytest

from rotorrig.identify.verdict.cross_validation import Fold, Prediction, pool_folds
from rotorrig.identify.verdict.gain import Predictions, choose_again


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
