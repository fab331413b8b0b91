"""A bearing that stiffens as its balls are thrown outwards."""

from dataclasses import replace

import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant

from ..by_hand import RPM, measured, run_to, steady


def test_at_one_speed_it_is_a_stiffer_bearing(rk4: RigConfig) -> None:
    """At twice the reference (1 + 4)^(1/3) - 1 over 2^(1/3) - 1 = 2.731 times the gain, and not four times: 8.19 %."""
    rig = rk4.model_copy(update={"gravity": "none"})
    values = {"gain": 0.03, "reference": 900 * RPM}
    plain = nameplate(rig)
    spring = plain.bearings[2]
    stiffer = replace(spring, kxx=1.0819 * spring.kxx, kyy=1.0819 * spring.kyy)
    named = run_to(Plant(rig, replace(plain, bearings=(*plain.bearings[:2], stiffer))), 1800)
    expected = measured(named, 1.0)
    assert steady(rig, "stiffness_over_speed", values, rpm=1800) == pytest.approx(expected, rel=5e-3)
    assert abs(steady(rig, "stiffness_over_speed", {"gain": 0.0}, rpm=1800)[0] / expected[0] - 1) > 0.05
