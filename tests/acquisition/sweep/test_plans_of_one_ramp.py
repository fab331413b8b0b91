"""Plans for a controller that keeps its ramp while it turns: one rate, or a sentence before anything moves."""

from pathlib import Path

import pytest

from rotorrig.acquisition.sweep.plans import plan_sweep
from rotorrig.acquisition.sweep.steps import Ramp
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import ConfigError

RK4 = (Path(__file__).parents[3] / "configs" / "rk4.toml").read_text()


def rig(profile: str, *, limits: str = "") -> RigConfig:
    text = RK4.replace('profile = "powerflex400"', profile).replace("[limits]\n", f"[limits]\n{limits}\n")
    return parse(text, where="x.toml")


def rates(rig: RigConfig) -> set[float]:
    return {round(step.rate * RPM, 6) for step in plan_sweep(rig) if isinstance(step, Ramp)}


def test_settling_has_a_ramp_of_its_own_where_the_drive_takes_any() -> None:
    assert rates(rig('profile = "acs355"')) == {30.0, 95.492966}


@pytest.mark.parametrize("profile", ['profile = "m-max"', 'profile = "vfd-ed"\nramp = "30 rpm/s"'])
def test_settling_has_the_plans_ramp_where_the_drive_keeps_one(profile: str) -> None:
    assert rates(rig(profile)) == {30.0}


def test_a_second_rate_is_refused_before_the_rotor_turns() -> None:
    passing = rig('profile = "m-max"', limits='critical_ramp = "60 rpm/s"')
    with pytest.raises(ConfigError) as error:
        plan_sweep(passing, criticals=(2226 / RPM,))
    assert str(error.value) == (
        "plans.default: ramps at 30 and 60 rpm/s, want one rate: a drive of profile m-max keeps it while it turns"
    )


def test_another_ramp_than_the_one_set_by_hand_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"ramps at 30 rpm/s, want the 45 rpm/s of motor.ramp, which is set by hand"):
        plan_sweep(rig('profile = "vfd-ed"\nramp = "45 rpm/s"'))
