"""The table of what the simulated rig is made of: complete, measured, and of mechanisms that differ."""

import json

import pytest

from benchmarks.parts.blind.names import ANSWERS
from docs.make_plant_differences import FIGURES, difference
from docs.plant_mechanisms import MECHANISMS
from rotorrig.sims.plant.faults.base import fault_names

KEPT = json.loads(FIGURES.read_text(encoding="utf-8"))


def test_every_fault_has_its_row_and_every_effect_its_figure() -> None:
    assert set(MECHANISMS) == set(fault_names())
    assert set(ANSWERS) == {name for name, m in MECHANISMS.items() if m.effect}
    assert set(KEPT) == set(ANSWERS), "python -m docs.make_plant_differences NAME measures it"


FLOOR = 5e-4  # by which two models of the healthy rotor alone are apart, as the definitions show


@pytest.mark.parametrize("name", [name for name, m in MECHANISMS.items() if name in KEPT and not m.is_definition])
def test_mechanisms_that_differ_show_it_and_each_effect_is_still_of_its_fault(name: str) -> None:
    assert FLOOR < KEPT[name] < 1.0


def test_half_the_mechanisms_are_further_from_their_effect_than_noise_would_hide() -> None:
    """Of 21 that differ ten by 1 % and more; the others are absorbed by what any identification fits.

    They were eleven until rotating damping got its exponent: a material that relaxes is within 0.4 % of that in what a
    sweep sees of it.
    """
    differ = [KEPT[name] for name, m in MECHANISMS.items() if m.effect and not m.is_definition]
    assert sum(figure >= 0.01 for figure in differ) >= 10


def test_a_figure_is_that_of_the_code() -> None:
    assert difference("unbalance_step") == pytest.approx(KEPT["unbalance_step"], rel=0.01)


@pytest.mark.campaign
@pytest.mark.parametrize("name", sorted(set(KEPT) - {"crack", "rub"}))  # which take minutes
def test_all_figures_are_those_of_the_code(name: str) -> None:
    assert difference(name) == pytest.approx(KEPT[name], rel=0.1, abs=1e-3)
