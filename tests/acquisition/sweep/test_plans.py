"""Plans as lists of steps: what is asked of the rig, in order, and what is refused before anything turns."""

from itertools import pairwise
from pathlib import Path

import pytest

from rotorrig.acquisition.sweep.critical_speeds import Band, critical_bands, pass_bands_quickly
from rotorrig.acquisition.sweep.plans import Ask, Coast, Dwell, Mark, Ramp, Rest, Step, Trial, plan_sweep
from rotorrig.acquisition.sweep.timeline import plan_timeline
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import ConfigError

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()
BAND = '\n[[limits.critical_bands]]\nlow = "2000 rpm"\nhigh = "2400 rpm"\nvibration = "1200 um"\n'


def rig_with(plan: str, *, limits: str = "", bands: str = "") -> RigConfig:
    """Return the RK4 with `[plans.test]` and more in `[limits]`."""
    text = RK4.replace('overspeed = "4000 rpm"', f'overspeed = "4000 rpm"\n{limits}')
    return parse(f"{text}\n[plans.test]\n{plan}\n{bands}", where="test.toml")


def speeds(plan: tuple[Step, ...]) -> list[int]:
    return [round(step.to * RPM) for step in plan if isinstance(step, Ramp)]


def marks(plan: tuple[Step, ...]) -> list[str]:
    return [step.label for step in plan if isinstance(step, Mark)]


RUN_UP = 'slow_roll = "240 rpm"\nslow_roll_time = "5 s"\nstart = "480 rpm"\nend = "3000 rpm"\nramp = "60 rpm/s"\n'


def test_a_run_up_ends_by_coasting_or_down_a_ramp() -> None:
    coasting = plan_sweep(rig_with(f'kind = "run-up-coast-down"\n{RUN_UP}'), "test")
    powered = plan_sweep(rig_with(f'kind = "run-up-ramp-down"\n{RUN_UP}'), "test")
    assert marks(coasting) == marks(powered) == ["settling", "slow roll", "settling", "up", "down", "end"]
    assert coasting[:-2] == powered[:-2]
    assert coasting[-2] == Coast(until=pytest.approx(480 / RPM))
    assert powered[-2] == Ramp(to=pytest.approx(480 / RPM), rate=pytest.approx(60 / RPM))


STEPPED = 'kind = "stepped"\nslow_roll = "240 rpm"\nslow_roll_time = "5 s"\nramp = "60 rpm/s"\ndwell = "4 s"\n'


@pytest.mark.parametrize(
    ("direction", "gone_through"),
    [("up", [600, 800, 1000]), ("down", [1000, 800, 600]), ("up-down", [600, 800, 1000, 800, 600])],
)
def test_a_stepped_plan_holds_every_speed_in_a_run_of_its_own(direction: str, gone_through: list[int]) -> None:
    grid = 'start = "600 rpm"\nend = "1050 rpm"\nstep = "200 rpm"\n'
    plan = plan_sweep(rig_with(f'{STEPPED}{grid}direction = "{direction}"'), "test")
    assert speeds(plan) == [240, *gone_through]
    assert [mark for mark in marks(plan) if mark.startswith("dwell")] == [f"dwell {rpm} rpm" for rpm in gone_through]
    at = plan.index(Mark(label="dwell 800 rpm"))
    assert plan[at - 2 : at] == (Ramp(to=pytest.approx(800 / RPM), rate=pytest.approx(60 / RPM)), Dwell(seconds=2.0))
    assert plan[at + 1 : at + 3] == (Dwell(seconds=4.0), Mark(label="settling"))


def test_a_grid_ends_where_it_says_when_its_steps_fit() -> None:
    grid = 'start = "600 rpm"\nend = "1000 rpm"\nstep = "100 rpm"\n'
    assert speeds(plan_sweep(rig_with(STEPPED + grid), "test")) == [240, 600, 700, 800, 900, 1000]


def test_a_stepped_plan_holds_other_speeds_when_asked_and_no_other_plan_does() -> None:
    rig = rig_with(STEPPED + 'start = "600 rpm"\nend = "1000 rpm"\nstep = "100 rpm"\n')
    held = [750 / RPM, 1480 / RPM]
    assert speeds(plan_sweep(rig, "test", speeds=held)) == [240, 750, 1480]
    with pytest.raises(ConfigError, match=r"plans\.test: goes to 9000 rpm, want less than the limit"):
        plan_sweep(rig, "test", speeds=[9000 / RPM])
    with pytest.raises(ConfigError, match="plan 'default': is of kind run-up-coast-down, want one of kind stepped"):
        plan_sweep(rig, "default", speeds=held)


def test_one_speed_can_be_held() -> None:
    plan = plan_sweep(rig_with('kind = "dwell"\nspeed = "900 rpm"\ntime = "60 s"\nramp = "60 rpm/s"'), "test")
    assert speeds(plan) == [900]
    assert marks(plan) == ["settling", "dwell 900 rpm", "settling"]


def test_trial_masses_come_after_a_baseline_one_at_a_time_with_the_rotor_at_rest() -> None:
    rig = rig_with('kind = "trial-mass"\nmasses = ["disk: 12 g mm at 0 deg", "disk: 12 g mm at 90 deg"]')
    plan, alone = plan_sweep(rig, "test"), plan_sweep(rig, "default")
    between = [step for step in plan if isinstance(step, Rest | Ask | Trial)]
    assert between == [
        Rest(),
        Ask(request="mount 'disk: 12 g mm at 0 deg'"),
        Trial(mass="disk: 12 g mm at 0 deg"),
        Rest(),
        Ask(request="take off 'disk: 12 g mm at 0 deg' and mount 'disk: 12 g mm at 90 deg'"),
        Trial(mass="none"),
        Trial(mass="disk: 12 g mm at 90 deg"),
    ]
    assert plan[: len(alone)] == alone
    assert plan[-len(alone) :] == alone


def test_a_plan_that_mounts_masses_is_not_run_with_one_on() -> None:
    rig = rig_with('kind = "trial-mass"\nmasses = ["disk: 12 g mm at 0 deg"]')
    with pytest.raises(ConfigError, match="plan 'test': mounts trial masses of its own, want it without --trial"):
        plan_sweep(rig, "test", trial=["disk: 1 g mm at 0 deg"])


def test_a_ramp_passes_a_critical_band_at_the_rate_that_is_asked_for_and_does_not_halt_at_its_edges() -> None:
    rig = rig_with(f'kind = "run-up-ramp-down"\n{RUN_UP}', limits='critical_ramp = "200 rpm/s"', bands=BAND)
    pieces = [step for step in plan_sweep(rig, "test") if isinstance(step, Ramp)][2:]
    assert [(round(p.to * RPM), round(p.rate * RPM), p.until and round(p.until * RPM)) for p in pieces] == [
        (3000, 60, 2000),
        (3000, 200, 2400),
        (3000, 60, None),
        (480, 60, 2400),
        (480, 200, 2000),
        (480, 60, None),
    ]


def test_a_ramp_that_is_quick_enough_is_left_alone() -> None:
    fast = [Ramp(to=300.0, rate=30.0)]
    assert list(pass_bands_quickly(fast, bands=[Band(low=200.0, high=250.0)], rate=20.0)) == fast


@pytest.mark.parametrize(
    ("end", "pieces"),
    [
        (150.0, [(5.0, None)]),  # below the band
        (220.0, [(5.0, 200.0), (20.0, None)]),  # into it
        (250.0, [(5.0, 200.0), (20.0, None)]),  # to its far edge
        (400.0, [(5.0, 200.0), (20.0, 250.0), (5.0, 300.0), (20.0, 330.0), (5.0, None)]),  # and through another
    ],
)
def test_a_ramp_is_cut_where_it_enters_and_leaves(end: float, pieces: list[tuple[float, float | None]]) -> None:
    two = [Band(low=200.0, high=250.0), Band(low=300.0, high=330.0)]
    cut = [
        step for step in pass_bands_quickly([Ramp(to=end, rate=5.0)], bands=two, rate=20.0) if isinstance(step, Ramp)
    ]
    assert [(step.rate, step.until) for step in cut] == pieces
    assert {step.to for step in cut} == {end}


def test_without_bands_in_the_config_those_of_a_model_count_where_a_rate_is_asked_for() -> None:
    plain = rig_with(f'kind = "run-up-coast-down"\n{RUN_UP}')
    asked = rig_with(f'kind = "run-up-coast-down"\n{RUN_UP}', limits='critical_ramp = "200 rpm/s"')
    criticals = [2226 / RPM, 2237 / RPM, 6000 / RPM]
    assert critical_bands(plain.limits, criticals) == ()
    assert [str(band) for band in critical_bands(asked.limits, criticals)] == ["2003-2461 rpm", "5400-6600 rpm"]
    assert plan_sweep(asked, "test") == plan_sweep(plain, "test")
    assert len(plan_sweep(asked, "test", criticals=criticals)) == len(plan_sweep(plain, "test")) + 2


def test_nothing_dwells_inside_a_critical_band() -> None:
    inside = 'kind = "dwell"\nspeed = "2200 rpm"\ntime = "60 s"\nramp = "60 rpm/s"'
    with pytest.raises(ConfigError, match=r"^plans.test: holds 2200 rpm inside the critical band 2000-2400 rpm"):
        plan_sweep(rig_with(inside, bands=BAND), "test")
    listed = f'{STEPPED}speeds = ["1000 rpm", "2100 rpm"]'
    with pytest.raises(ConfigError, match="holds 2100 rpm inside"):
        plan_sweep(rig_with(listed, bands=BAND), "test")


def test_a_grid_of_speeds_leaves_a_critical_band_out() -> None:
    grid = 'start = "1800 rpm"\nend = "2600 rpm"\nstep = "100 rpm"\n'
    assert speeds(plan_sweep(rig_with(STEPPED + grid, bands=BAND), "test")) == [240, 1800, 1900, 2500, 2600]


def test_a_plan_beyond_the_limits_is_refused() -> None:
    slow_drive = RK4.replace('max_speed = "4200 rpm"', 'max_speed = "2500 rpm"')
    for text in (RK4, slow_drive):
        rig = parse(text.replace('overspeed = "4000 rpm"', 'overspeed = "2500 rpm"'), where="test.toml")
        with pytest.raises(
            ConfigError, match=r"^plans.default: goes to 3600 rpm, want less than the limit of 2500 rpm"
        ):
            plan_sweep(rig)


def test_the_timeline_of_a_plan_is_whole_and_adds_up() -> None:
    rig = rig_with(f'kind = "run-up-ramp-down"\n{RUN_UP}')
    timed = plan_timeline(plan_sweep(rig, "test"))
    assert timed[0].begin == 0.0
    for before, after in pairwise(timed):
        assert before.end == after.begin
        assert before.to == after.speed
    # 240 and 240 rpm at 10 rad/s^2, dwells of 1, 5, 1 and 1 s, and 2520 rpm at 60 rpm/s up and down
    assert timed[-1].end == pytest.approx(480 / RPM / 10 + 8 + 2 * 2520 / 60)


def test_a_stop_between_two_runs_takes_the_time_of_the_last_ramp() -> None:
    timed = plan_timeline([Ramp(to=100.0, rate=20.0), Rest(), Ramp(to=50.0, rate=10.0)])
    assert [(t.begin, t.end, t.to) for t in timed] == [(0.0, 5.0, 100.0), (5.0, 10.0, 0.0), (10.0, 15.0, 50.0)]
