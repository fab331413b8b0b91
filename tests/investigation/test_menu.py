"""The runs that are added to a config say what they are for, and nothing else in it changes."""

from pathlib import Path

import pytest

from rotorrig.acquisition.sweep import plan_sweep
from rotorrig.investigation.menu import add_runs
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, Stepped, load, parse

RK4 = Path(__file__).parents[2] / "configs/rk4.toml"


def test_the_menu_of_the_rk4() -> None:
    rig = load(RK4)
    with_menu, menu = add_runs(rig, "default")
    given, slower, faster = (with_menu.plans[name] for name in ("default", menu.slower, menu.faster))
    assert given == rig.plans["default"]
    assert (slower.ramp * RPM, faster.ramp * RPM) == pytest.approx((10.0, 90.0))  # type: ignore[union-attr]
    held = with_menu.plans[menu.held]
    assert isinstance(held, Stepped)
    assert (held.dwell, len(held.rising)) == (20.0, 4)
    tops = [with_menu.plans[name].fastest * RPM for name, _ in menu.higher]
    assert tops == pytest.approx([3650.0, 3700.0, 3750.0, 3800.0]), "to 95 % of 4000 rpm"
    for name in menu.names:
        assert plan_sweep(with_menu, name), "and each is allowed"
    same = {"plans"}
    assert with_menu.model_dump(exclude=same) == rig.model_dump(exclude=same)
    assert with_menu.text.startswith(rig.text.rstrip()), "comments and all"
    assert parse(with_menu.text, where="again").hash == with_menu.hash


def test_a_name_that_is_taken_and_a_plan_that_is_not_there_are_refused() -> None:
    with_menu, _ = add_runs(load(RK4), "default")
    with pytest.raises(ConfigError, match=r"plans\.default-faster: an investigation adds a plan of that name"):
        add_runs(with_menu, "default")
    with pytest.raises(ConfigError, match="plan 'fast': the config has none of that name"):
        add_runs(with_menu, "fast")


def test_a_rig_that_was_made_in_code_gets_a_text() -> None:
    rig = load(RK4)
    made = rig.model_copy(update={"name": "made"})
    made._text = ""
    with_menu, menu = add_runs(made, "default")
    assert parse(with_menu.text, where="again").plans.keys() == {"default", *menu.names}


def test_of_another_kind_of_plan_there_is_the_base_alone() -> None:
    text = RK4.read_text() + '\n[plans.hold]\nkind = "dwell"\nspeed = "900 rpm"\ntime = "5 s"\nramp = "30 rpm/s"\n'
    rig = parse(text, where="hold")
    with_menu, menu = add_runs(rig, "hold")
    assert (with_menu, menu.names) == (rig, ())
