"""A cause in words, from figures known by hand."""

import dataclasses
import math

import pytest

from rotorrig.app.text.causes import (
    LISTED,
    cause_evidence,
    cause_prediction_error,
    cause_size,
    cause_status,
    causes_to_list,
    gain_sentence,
    hidden_effect_text,
    next_run_sentence,
    parameter_shifts,
)
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.verdict.cause import ParameterValue
from rotorrig.identify.verdict.gain import Shift
from rotorrig.identify.verdict.next_run.choice import NextRun
from rotorrig.identify.verdict.verdict import HiddenEffect
from tests.app.conftest import make_cause, make_gain

BOW = make_cause("bow", "residual bow", chosen=True, evidence=800.0, after=4.1e-7)


def test_a_single_phasor_needs_no_name() -> None:
    assert cause_size(BOW) == "18.00 ± 0.30 µm at 110.0 ± 1.0°"


def test_several_figures_are_told_apart_by_their_names() -> None:
    several = {
        "force 1X": ParameterValue(value=0.3, unit="N", sigma=0.01),
        "force 2X": ParameterValue(value=0.1, unit="N", sigma=0.02),
    }
    angle = {"force 1X angle": ParameterValue(value=math.pi, unit="rad", sigma=math.inf)}
    assert (
        cause_size(dataclasses.replace(BOW, parameters=several | angle))
        == "force 1X 0.300 ± 0.010 N at 180°, force 2X 0.100 ± 0.020 N"
    )


def test_a_size_that_no_rig_has_is_not_told() -> None:
    assert cause_size(dataclasses.replace(BOW, plausible=False)) == "–"


@pytest.mark.parametrize(
    ("before", "after", "said"), [(1.234e-4, 2e-6, "123 → 2.00"), (5.2e-6, 4.1e-7, "5.20 → 0.410")]
)
def test_errors_have_three_digits(before: float, after: float, said: str) -> None:
    assert cause_prediction_error(dataclasses.replace(BOW, heldout_before=before, heldout_after=after)) == said


def test_what_was_not_measured_is_a_dash() -> None:
    assert cause_prediction_error(dataclasses.replace(BOW, heldout_after=math.nan)) == "–"


def test_why_there_is_no_next_run_is_said_without_a_separation(named: Diagnosis) -> None:
    none = NextRun(kind="none", words="No next run could be computed: no motion.", lam=math.nan, separates=("bow",))
    assert next_run_sentence(dataclasses.replace(named, next_run=none)) == none.words


def test_how_near_the_next_run_comes_to_a_limit_is_said(named: Diagnosis) -> None:
    calm = NextRun(kind="ramp rate", words="Slower.", lam=math.nan, separates=(), share_of_limit=0.4)
    loud = dataclasses.replace(calm, share_of_limit=1.17)
    said, warned = (next_run_sentence(dataclasses.replace(named, next_run=run)) for run in (calm, loud))
    assert said == "Slower. Its vibration stays below 40 % of the limit, with 95 % probability."
    assert warned == "Slower. Its vibration may come near the limit: below 117 % of the limit, with 95 % probability."


def test_the_chosen_and_the_tied_are_listed_however_many_are_better(named: Diagnosis) -> None:
    others = [dataclasses.replace(make_cause(f"effect {i}", "", evidence=100.0 - i, after=1e-6)) for i in range(20)]
    found = dataclasses.replace(named, causes=(BOW, *others), tied=(("bow", "effect 19"),))
    labels = [cause.label for cause in causes_to_list(found)]
    assert labels == ["bow", *(f"effect {i}" for i in range(LISTED - 1)), "effect 19"]
    assert cause_status(others[19], found) == "tied"
    assert cause_status(BOW, found) == "in the model, tied"


def test_a_model_that_was_not_extended_has_no_gain(good: Diagnosis) -> None:
    assert gain_sentence(good) == ""
    assert next_run_sentence(good) == ""
    assert list(parameter_shifts(good)) == []


def test_a_phase_moves_the_short_way_round(named: Diagnosis) -> None:
    turned = dataclasses.replace(
        named, gain=make_gain({"phase": Shift(before=-3.1, after=3.1, sigma=0.01, unit="rad")})
    )
    ((_, _, _, moved),) = parameter_shifts(turned)
    assert moved == "-8.3 σ"  # 6.2 - 2 pi = -0.083


def test_an_effect_no_size_of_which_would_show_says_so() -> None:
    effect = HiddenEffect(effect="couple", smallest=math.inf, unit="rad", missing="a second plane")
    assert hidden_effect_text(effect) == "couple: not detectable at any size; needs a second plane"


def test_a_fit_that_was_given_up_says_the_least_it_could_be() -> None:
    assert cause_evidence(BOW) == "800"
    assert cause_evidence(dataclasses.replace(BOW, given_up=True)) == "≥ 800"
