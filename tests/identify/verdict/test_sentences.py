"""The verdict as a sentence."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.adequacy.residual_tests import Adequacy
from rotorrig.identify.verdict.cause import Cause
from rotorrig.identify.verdict.cross_validation import Prediction
from rotorrig.identify.verdict.gain import Predictions
from rotorrig.identify.verdict.sentences import character, sentence
from rotorrig.identify.verdict.verdict import Verdict

RPM = np.pi / 30
LOUD = Misfit(
    run="up",
    probe="2y",
    order=1.0,
    speed_from=1800 * RPM,
    speed_to=2200 * RPM,
    sigma=38.0,
    residual=5e-6,
    relative=-0.23,
    phase=-0.24,
    sentence="In the up run, probe 2y departs.",
)
WRONG = Adequacy(
    adequate=False,
    p=1e-9,
    scatter_ratio=4.0,
    worst_sigma=38.0,
    limit=2.6,
    misfits=(LOUD, replace(LOUD, run="down", probe="1x", speed_to=2600 * RPM, sigma=9.0)),
    residual=np.zeros((1, 1, 1), complex),
    sigmas=np.zeros((1, 1, 1)),
    noise_floor=1e-7,
)
RIGHT = replace(WRONG, adequate=True, p=0.4, scatter_ratio=1.02, worst_sigma=1.2)
BOW = Cause(
    label="bow",
    effect="bow",
    where="",
    title="residual shaft bow",
    words="the shaft is bowed by 18 um",
    chosen=True,
    plausible=True,
    evidence=90.0,
    lam=100.0,
    heldout_before=2e-6,
    heldout_after=5e-7,
    parameters={},
    theta={},
    sigmas={},
)
OTHER = replace(BOW, label="runout, plane 1", words="the surface runs out", chosen=False)
BOUGHT = Predictions(
    before=Prediction(error=2e-6, floor=5e-7, expected=5e-7, sigmas=4.0, blocks=np.full(9, 16.0)),
    after=Prediction(error=5e-7, floor=5e-7, expected=5e-7, sigmas=1.0, blocks=np.full(9, 1.0)),
    by_label={},
    on="blocks of speeds in turn",
)


def said(verdict: Verdict, *causes: Cause, tied: tuple[tuple[str, ...], ...] = (), bought: Predictions = BOUGHT) -> str:
    after = WRONG if verdict is Verdict.UNEXPLAINED else RIGHT
    before = RIGHT if verdict in {Verdict.ADEQUATE, Verdict.CANNOT_TELL} else WRONG
    return sentence(verdict, before, after, causes, tied, bought)


def test_a_cause_that_eases_the_priors_is_told_with_what_would_be_wrong_without_it() -> None:
    even = replace(BOUGHT, after=replace(BOUGHT.before, error=2.1e-6))
    misstated = ("probe 1y is turned by 10 deg (9.0 sigma)", "runout 1x by 9.9 sigma")
    told = sentence(Verdict.NAMED, RIGHT, RIGHT, (BOW,), (), even, misstated)
    assert "error on data no fit saw (blocks of speeds in turn) is 2 um 0-peak, with it 2.1 um 0-peak; but then" in told
    assert told.endswith(
        "the config would have to be wrong: probe 1y is turned by 10 deg (9.0 sigma); runout 1x by 9.9 sigma."
    )
    assert "would have to be wrong" not in sentence(Verdict.NAMED, WRONG, RIGHT, (BOW,), (), BOUGHT, misstated)


def test_a_cause_that_predicts_worse_is_said_to() -> None:
    worse = Prediction(error=3e-6, floor=5e-7, expected=5e-7, sigmas=6.0, blocks=np.full(9, 36.0))
    words = said(Verdict.UNEXPLAINED, BOW, bought=replace(BOUGHT, after=worse))
    assert "With bow it fits better, but does not clearly predict data no fit saw" in words
    assert "any better: off by 3 um 0-peak, 2 um 0-peak without" in words
    alike = said(Verdict.UNEXPLAINED, BOW, bought=replace(BOUGHT, after=replace(worse, error=2e-6)))
    assert "any better: off by 2 um 0-peak, as without" in alike


@pytest.mark.parametrize("verdict", [Verdict.ADEQUATE, Verdict.CANNOT_TELL])
def test_a_model_that_fits_is_said_with_its_figures_and_their_limits(verdict: Verdict) -> None:
    words = said(verdict)
    assert "1.02" in words
    assert "1.2 sigma" in words
    assert "limit" in words
    assert ("adequate" in words) == (verdict is Verdict.ADEQUATE)
    assert ("cannot tell" in words) == (verdict is Verdict.CANNOT_TELL)


def test_a_named_cause_is_said_with_what_it_bought() -> None:
    words = said(Verdict.NAMED, BOW, OTHER)
    assert BOW.words in words
    assert OTHER.words not in words
    assert "from 2 to 0.5 um 0-peak" in words
    assert "1.0 times the noise floor" in words


def test_a_named_cause_that_leaves_more_than_noise_is_said_to() -> None:
    assert "not yet all" not in said(Verdict.NAMED, BOW)
    words = sentence(Verdict.NAMED, WRONG, WRONG, [BOW], (), BOUGHT)
    assert "That is not yet all: 1X residuals at 4 times their scatter" in words


def test_a_tie_names_the_rivals_but_not_the_chosen_one_again() -> None:
    words = said(Verdict.TIED, BOW, OTHER, tied=(("bow", "runout, plane 1"),))
    assert BOW.words in words
    assert "runout, plane 1" in words


def test_no_cause_found_says_where_it_is_wrong() -> None:
    words = said(Verdict.UNEXPLAINED, OTHER)
    assert "NOT adequate" in words
    assert LOUD.sentence in words
    assert "None of the known causes" in words
    assert "Not even with bow" in said(Verdict.UNEXPLAINED, BOW)


def test_the_character_of_a_residual_spans_all_that_is_loud() -> None:
    words = character(WRONG)
    assert "at 1X" in words
    assert "from 1800 to 2600 rpm" in words
    assert "down and up runs" in words
    assert "1x, 2y" in words
