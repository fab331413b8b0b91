"""Balancing by the fitted model, without a trial run, and with one: the RK4 swept by the model itself."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.balancing import Balance, Holes, Task, balance
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError
from tests.balancing.fits import TRIAL
from tests.identify.swept import U

MARK = np.radians(2.0)  # prior of the mark in configs/rk4.toml


@pytest.fixture(scope="module")
def by_model(runs: list[OrderTrackedResponse], fit: Identification) -> Balance:
    return balance(runs[:1], Task(), identification=fit, after=runs[2])


def test_without_a_trial_run_the_correction_is_opposite_the_unbalance(by_model: Balance) -> None:
    (correction,) = by_model.corrections
    assert pytest.approx([-U], rel=0.02) == correction.W
    ((amount, angle),) = correction.half_widths
    assert abs(abs(correction.W[0]) - abs(U)) < amount < 0.06 * abs(U)
    assert 1.96 * MARK <= angle < 1.2 * 1.96 * MARK  # the mark is known no better than the config says


def test_the_model_predicts_the_balanced_run(by_model: Balance) -> None:
    prediction, comparison = by_model.prediction, by_model.comparison
    assert comparison is not None and comparison.share > 0.9
    assert np.abs(prediction.after).max() < 0.05 * np.abs(prediction.before).max()
    assert (by_model.mounted == [-U]).all()  # as the run after says


def test_with_a_trial_run_both_methods_agree_and_the_mark_no_longer_matters(
    runs: list[OrderTrackedResponse], fit: Identification
) -> None:
    found = balance(runs[:2], Task(), identification=fit)
    assert len(found.corrections) == 3
    assert found.disagreement < 1
    assert pytest.approx([-U], rel=0.01) == found.chosen.W
    assert found.chosen.half_widths[0][1] < 0.5 * MARK


def test_a_mark_that_is_off_shows_as_disagreement(runs: list[OrderTrackedResponse], fit: Identification) -> None:
    turned = replace(
        runs[1], runs=tuple(replace(r, trial_unbalance={"disk": TRIAL * np.exp(0.35j)}) for r in runs[1].runs)
    )
    found = balance([runs[0], turned], Task(), identification=fit)
    assert found.disagreement > 1
    assert found.chosen.by == "influence coefficients"


def test_holes_and_bands_are_those_asked_for(runs: list[OrderTrackedResponse]) -> None:
    holes = {"disk": Holes(count=16, masses=(1e-4, 2e-4, 5e-4), radius=0.03)}
    task = Task(holes=holes, bands=((100.0, 200.0),))
    found = balance(runs[:2], task)
    assert found.placing is not None
    assert abs(found.placing.W[0] + U) < 0.2 * abs(U)
    assert (found.mounted == found.placing.W).all()
    assert found.prediction.omega.max() <= 200.0


def test_a_fit_of_other_responses_is_refused(runs: list[OrderTrackedResponse], fit: Identification) -> None:
    with pytest.raises(DataError, match="a response that was not given"):
        balance(runs[1:2], Task(), identification=fit)


def test_neither_trial_mass_nor_fit_is_refused(runs: list[OrderTrackedResponse]) -> None:
    with pytest.raises(DataError, match="no run has a trial mass and there is no fit"):
        balance(runs[:1], Task())


def test_runs_without_a_common_speed_are_refused(runs: list[OrderTrackedResponse]) -> None:
    with pytest.raises(DataError, match="no speed in common"):
        balance(runs[:2], Task(bands=((1.0, 2.0),)))
