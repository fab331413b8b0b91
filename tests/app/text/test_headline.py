"""What a diagnosis says first: a bow of 18 um at 110 degrees, whatever it is called (tests/app/conftest.py)."""

import dataclasses

import pytest

from rotorrig.app.text.headline import headline
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.verdict.cause import ParameterValue
from tests.app.conftest import WRONG_CONFIG, make_cause, make_missing

BOW = make_cause("bow, even", "residual bow", chosen=True, evidence=800.0, after=4.1e-7)
GAIN = dataclasses.replace(
    make_cause("probe_gain, probe 1x", "probe gain", chosen=True, evidence=90.0, after=4.1e-7),
    parameters={"gain": ParameterValue(value=0.0312, unit="", sigma=0.002)},
)


@pytest.fixture
def alone(named: Diagnosis) -> Diagnosis:
    return dataclasses.replace(named, causes=(BOW,), tied=())


def test_a_cause_is_said_as_across_the_bench(alone: Diagnosis) -> None:
    assert headline(alone) == "Bent shaft: 18.0 µm at 110°. It explains what the model got wrong."
    hardly = {"bow": ParameterValue(value=16.5e-6, unit="m", sigma=2.2e-6)}
    vague = dataclasses.replace(alone, causes=(dataclasses.replace(BOW, parameters=hardly),))
    assert headline(vague).startswith("Bent shaft: 16 µm. "), "no digit beyond the first of its sigma"


def test_a_cause_of_many_values_is_said_by_its_name_alone(alone: Diagnosis) -> None:
    values = {name: ParameterValue(value=1.0, unit="", sigma=0.1) for name in ("mass", "frequency", "damping ratio")}
    pedestal = make_cause("pedestal, x", "pedestal", chosen=True, evidence=9e3, after=4e-7)
    diagnosis = dataclasses.replace(alone, causes=(dataclasses.replace(pedestal, parameters=values),))
    assert headline(diagnosis).endswith(", x. It explains what the model got wrong.")
    assert not any(digit in headline(diagnosis) for digit in "0123456789")


def test_two_causes_explain_it_together(alone: Diagnosis) -> None:
    both = dataclasses.replace(alone, causes=(BOW, GAIN))
    words = "Bent shaft: 18.0 µm at 110°; probe gain, probe 1x: 3.1 %. Together they explain what the model got wrong."
    assert headline(both) == words


def test_what_is_left_unexplained_is_not_claimed(alone: Diagnosis) -> None:
    partly = dataclasses.replace(alone, sentence="The model is wrong here: a bow. That is not yet all: p = 0.001.")
    assert headline(partly).endswith("It explains most of what the model got wrong.")


def test_a_tie_names_who_else_it_may_be(alone: Diagnosis) -> None:
    tied = dataclasses.replace(alone, verdict=Verdict.TIED, tied=(("bow, even", "runout, plane 2"),))
    assert headline(tied) == "Bent shaft: 18.0 µm at 110°; or as likely runout, plane 2. This data cannot tell which."


def test_a_wrong_config_is_said_with_what_is_wrong(alone: Diagnosis) -> None:
    cause = dataclasses.replace(BOW, nameplate=True)
    wrong = dataclasses.replace(alone, causes=(cause,), nameplate=WRONG_CONFIG)
    assert headline(wrong) == (
        "The config is wrong about this rig: "
        "bearing spring sits 2.10 mm further from the coupling than the config says. "
        "With what it should say, the model describes this run."
    )


def test_a_missing_force_has_its_place(alone: Diagnosis) -> None:
    missing = dataclasses.replace(alone, verdict=Verdict.DESCRIBED, missing=make_missing())
    assert (
        headline(missing) == "A force that the model lacks acts at 485 mm from the coupling; no known cause is like it."
    )


def test_a_model_that_holds_and_data_that_cannot_tell_are_said_to(good: Diagnosis, poor: Diagnosis) -> None:
    assert headline(good) == "The model describes this run."
    assert "cannot decide" in headline(dataclasses.replace(good, verdict=Verdict.CANNOT_TELL))
    assert headline(poor) == "The model does NOT describe this run."
    assert headline(dataclasses.replace(poor, cut_short=True)).endswith("The search for causes was cut short.")
