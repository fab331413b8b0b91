"""The config against a fit in words, from figures known by hand."""

import dataclasses
import math

import pytest

from rotorrig.app.text.causes import cause_size, cause_status
from rotorrig.app.text.nameplate import finding_sentences, found_text, misfit_sentence, pull_rows, stated_text
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification, NameplateCheck, Pull
from rotorrig.identify.verdict.cause import ParameterValue
from tests.app.conftest import OFF, WRONG_CONFIG, make_cause


def test_a_position_is_told_in_millimetres_beside_the_stated_one() -> None:
    assert (stated_text(OFF), found_text(OFF)) == ("481 mm", "483.10 ± 0.20 mm")


@pytest.mark.parametrize(
    ("value", "sigma", "unit", "nameplate", "nameplate_unit", "stated", "found"),
    [
        (0.02, 0.004, "", 0.01, "m", "10 mm", "10.200 ± 0.040 mm"),
        (-0.05, 0.01, "", 2.0e11, "Pa", "200 GPa", "190.0 ± 2.0 GPa"),
        (0.04, 0.005, "", 7870.0, "V/m", "7.87 mV/µm", "8.185 ± 0.039 mV/µm"),
        (0.22, 0.03, "", math.nan, "", "–", "+22.0 ± 3.0 %"),
        (math.pi / 60, math.pi / 360, "rad", math.pi / 2, "rad", "90°", "93.00 ± 0.50°"),
        (120.0, 20.0, "N m/rad", 0.0, "N m/rad", "0 N m/rad", "120 ± 20 N m/rad"),
    ],
)
def test_other_statements_are_told_in_their_units(
    value: float, sigma: float, unit: str, nameplate: float, nameplate_unit: str, stated: str, found: str
) -> None:
    deviation = dataclasses.replace(
        OFF, value=value, sigma=sigma, unit=unit, nameplate=nameplate, nameplate_unit=nameplate_unit
    )
    assert (stated_text(deviation), found_text(deviation)) == (stated, found)


def test_a_stiffness_of_less_than_nothing_is_not_shown() -> None:
    stiff = {"nameplate": 2e6, "nameplate_unit": "N/m", "unit": "", "sigma": 0.1}
    assert found_text(dataclasses.replace(OFF, **stiff, value=-24.0)) == "none that can be"
    assert found_text(dataclasses.replace(OFF, **stiff, value=-0.5)) == "1000 ± 200 kN/m"
    turned = {"nameplate": 1.0, "nameplate_unit": "rad", "unit": "rad", "sigma": 0.01}
    assert found_text(dataclasses.replace(OFF, **turned, value=-1.5)) == "-28.65 ± 0.57°"


def test_only_groups_pulled_by_more_than_two_sigmas_have_a_row() -> None:
    slight = Pull(group="shaft stiffness", sigmas=1.9, deviations=(OFF,))
    check = NameplateCheck(pulls=(*WRONG_CONFIG.pulls, slight))
    assert list(pull_rows(check)) == [
        ("position of bearing spring", "481 mm", "483.10 ± 0.20 mm", "4.6 σ (positions)"),
    ]


def test_a_finding_is_a_sentence() -> None:
    assert finding_sentences(WRONG_CONFIG) == [
        "Bearing spring sits 2.10 ± 0.20 mm further from the coupling than the config says (4.6 sigma)."
    ]


def test_a_statement_that_is_wrong_is_no_effect_in_the_model(named: Diagnosis) -> None:
    size = {"off": ParameterValue(value=2.1e-3, unit="m", sigma=2e-4)}
    cause = dataclasses.replace(
        make_cause("bearing_position, spring", "", chosen=True, evidence=20.0, after=1e-6),
        nameplate=True,
        parameters=size,
    )
    assert cause_size(cause) == "+2.10 ± 0.20 mm"
    assert cause_status(cause, named) == "config wrong"


def test_a_poor_fit_is_said_to_be_and_what_to_do(identification: Identification) -> None:
    fit = dataclasses.replace(identification.fits[0], p=0.4, scatter_ratio=1.02)
    assert misfit_sentence(fit) == (
        "Misfit: chi2 2950 over 2910 degrees of freedom, 1.01; 1X residuals are 1.02 times their scatter from row to "
        "row (p = 0.4)."
    )
    poor = misfit_sentence(dataclasses.replace(fit, p=1e-9, scatter_ratio=4.0, adequate=False))
    assert poor.startswith("The fit is poor: 1X residuals are 4 times their scatter from row to row (p < 0.0001)")
    assert "Run rotor diagnose." in poor


def test_of_an_older_file_the_misfit_alone_is_known(identification: Identification) -> None:
    assert misfit_sentence(identification.fits[0]) == "Misfit: chi2 2950 over 2910 degrees of freedom, 1.01."
