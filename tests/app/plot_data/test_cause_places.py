"""Where a cause is drawn: on configs/rk4.toml, whose probes 1x, 1y are at 250.5 mm and whose spring is at 481 mm."""

import dataclasses

import pytest

from rotorrig.app.plot_data.cause_places import cause_places
from rotorrig.identify.verdict.cause import ParameterValue
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import catalogue
from tests.app.conftest import make_cause


@pytest.mark.parametrize(
    ("label", "places"),
    [
        ("probe_gain, probe 1x", [0.2505]),
        ("probe_angle, probe 2y", [0.3805]),
        ("unbalance_plane, at 381 mm", [0.381]),
        ("bearing_position, spring", [0.481]),  # no effect: a statement of the config
        ("bow, even", []),  # all of the shaft
        ("line_hum, 50 Hz", []),
        ("coupling", [0.0]),  # from where places are counted
    ],
)
def test_a_cause_is_where_its_part_of_the_rig_is(rig: RigConfig, label: str, places: list[float]) -> None:
    cause = make_cause(label, "", evidence=1.0, after=1e-6)
    assert list(cause_places(cause, rig)) == pytest.approx(places)


def test_every_effect_that_names_a_part_has_a_place(rig: RigConfig) -> None:
    nowhere = {
        e.name for e in catalogue(rig) if not cause_places(make_cause(e.label, "", evidence=1.0, after=1.0), rig)
    }
    crack, shapes = "crack", {"bow", "internal_damping", "shaft_asymmetry"}  # a crack's place comes with its fit
    assert nowhere == {crack, *shapes, "line_hum", "slow_roll_subtracted"}


def test_a_crack_is_where_it_was_found(rig: RigConfig) -> None:
    place = {"place": ParameterValue(value=0.333, unit="m", sigma=0.02)}
    crack = dataclasses.replace(make_cause("crack", "", evidence=1.0, after=1e-6), parameters=place)
    assert cause_places(crack, rig) == (0.333,)
