"""Sweep plans as generators of steps: run-up and coast-down, stepped, dwell, trial-mass runs.

`list(plan)` is a sweep's preview and its limit check; the engine runs the same steps.
"""

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import replace
from typing import TypeGuard, assert_never

from rotorrig.acquisition.sweep.critical_speeds import Band, critical_bands, dwells_in_bands, pass_bands_quickly
from rotorrig.acquisition.sweep.steps import Ask, Coast, Dwell, Mark, Ramp, Rest, Step, Trial
from rotorrig.rig import ConfigError
from rotorrig.rig.config import (
    NO_TRIAL,
    RPM,
    SAME_RAMP,
    DwellAt,
    ModbusRtu,
    ModbusTcp,
    Motor,
    Plan,
    RigConfig,
    RunUpCoastDown,
    RunUpRampDown,
    Stepped,
    TrialMassRuns,
    read_trial_mass,
)

__all__ = ["Ask", "Coast", "Dwell", "Mark", "Ramp", "Rest", "Step", "Trial", "draft_sweep", "objections", "plan_sweep"]

SETTLING_RAMP = 10.0  # rad/s^2, about 95 rpm/s: gentle, and outside the recorded runs


def run_up_coast_down(plan: RunUpCoastDown) -> Iterator[Step]:
    """Yield a slow-roll dwell, a ramp from start to end, then a coast-down to the start speed."""
    yield from run_up(plan)
    yield Mark(label="down")
    yield Coast(until=plan.start)
    yield Mark(label="end")


def run_up_ramp_down(plan: RunUpRampDown) -> Iterator[Step]:
    """Yield a slow-roll dwell, a ramp from start to end and one back."""
    yield from run_up(plan)
    yield Mark(label="down")
    yield Ramp(to=plan.start, rate=plan.ramp)
    yield Mark(label="end")


def run_up(plan: RunUpCoastDown | RunUpRampDown) -> Iterator[Step]:
    """Yield a slow-roll dwell and a ramp from start to end."""
    yield from slow_roll(plan.slow_roll, seconds=plan.slow_roll_time)
    yield Ramp(to=plan.start, rate=SETTLING_RAMP)
    yield Dwell(seconds=1.0)
    yield Mark(label="up")
    yield Ramp(to=plan.end, rate=plan.ramp)
    yield Dwell(seconds=1.0)


def slow_roll(speed: float, *, seconds: float) -> Iterator[Step]:
    """Yield a dwell at a speed [rad/s] so low that the probes see run-out and bow alone."""
    yield Mark(label="settling")
    yield Ramp(to=speed, rate=SETTLING_RAMP)
    yield Dwell(seconds=1.0)
    yield Mark(label="slow roll")
    yield Dwell(seconds=seconds)
    yield Mark(label="settling")


def stepped_speeds(plan: Stepped, *, avoid: Sequence[Band] = ()) -> Iterator[Step]:
    """Yield a slow-roll dwell and a run of its own at every speed; a grid leaves out speeds in the bands to avoid."""
    yield from slow_roll(plan.slow_roll, seconds=plan.slow_roll_time)
    rising = [s for s in plan.rising if plan.listed or not any(s in band for band in avoid)]
    falling = rising[::-1]
    speeds = {"up": rising, "down": falling, "up-down": rising + falling[1:]}[plan.direction]
    for speed in speeds:
        yield Ramp(to=speed, rate=plan.ramp)
        yield from dwell_run(speed, settle=plan.settle, seconds=plan.dwell)


def single_dwell(plan: DwellAt) -> Iterator[Step]:
    """Yield a run at one speed."""
    yield Mark(label="settling")
    yield Ramp(to=plan.speed, rate=plan.ramp)
    yield from dwell_run(plan.speed, settle=plan.settle, seconds=plan.time)


def dwell_run(speed: float, *, settle: float, seconds: float) -> Iterator[Step]:
    """Yield a run at the speed [rad/s] just reached, once it has settled."""
    yield Dwell(seconds=settle)
    yield Mark(label=f"dwell {speed * RPM:.0f} rpm")
    yield Dwell(seconds=seconds)
    yield Mark(label="settling")


def trial_mass_runs(masses: Sequence[str], runs: Sequence[Step]) -> Iterator[Step]:
    """Yield `runs` as baseline, then again with each mass, mounted at rest after the one before was taken off."""
    yield from runs
    before = ""
    for mass in masses:
        yield Rest()
        yield Ask(request=(f"take off '{before}' and mount '{mass}'" if before else f"mount '{mass}'"))
        if before:
            yield Trial(mass=NO_TRIAL)
        yield Trial(mass=mass)
        yield from runs
        before = mass


def plan_sweep(
    rig: RigConfig,
    name: str = "default",
    *,
    trial: Sequence[str] = (),
    speeds: Sequence[float] = (),
    criticals: Sequence[float] = (),
) -> tuple[Step, ...]:
    """Return the steps of the plan `name`, checked against the rig's limits. Raises ConfigError.

    `trial` are the trial masses on the rotor, as `read_trial_mass` reads them; they are noted first. A stepped plan
    holds `speeds` [rad/s] instead of its own, if there are any. `criticals` are the critical speeds of a model [rad/s],
    which count where the config has no bands, see `critical_bands`.
    """
    plan = draft_sweep(rig, name, trial=trial, speeds=speeds, criticals=criticals)
    for objection in objections(rig, plan, criticals=criticals):
        raise ConfigError(f"plans.{name}: {objection}")
    return plan


def draft_sweep(
    rig: RigConfig,
    name: str,
    *,
    trial: Sequence[str] = (),
    speeds: Sequence[float] = (),
    criticals: Sequence[float] = (),
) -> tuple[Step, ...]:
    """Return the steps of the plan `name`, allowed or not; arguments as of `plan_sweep`.

    Raises ConfigError for an unknown plan or trial mass, and for speeds of a plan that has none to hold.
    """
    for mass in trial:
        read_trial_mass(mass, planes=rig.unbalance_planes)
    if name not in rig.plans:
        raise ConfigError(f"plan '{name}': the config has none of that name, want one of {sorted(rig.plans)}")
    plan = rig.plans[name]
    if trial and isinstance(plan, TrialMassRuns):
        raise ConfigError(f"plan '{name}': mounts trial masses of its own, want it without --trial")
    if speeds and not isinstance(plan, Stepped):
        raise ConfigError(f"plan '{name}': is of kind {plan.kind}, want one of kind stepped to hold speeds with --hold")
    if speeds:
        plan = plan.model_copy(update={"speeds": tuple(speeds), "start": None, "end": None, "step": None})
    bands = critical_bands(rig.limits, criticals)
    rate = rig.limits.critical_ramp if rig.limits else None
    steps = pass_bands_quickly(_generate(plan, rig, bands), bands=bands, rate=rate)
    if _keeps_ramp(rig.motor):
        steps = _settle_at_own_rate(tuple(steps))
    return (*(Trial(mass=mass) for mass in trial), *steps)


def objections(rig: RigConfig, plan: Iterable[Step], *, criticals: Sequence[float] = ()) -> Iterator[str]:
    """Yield the reasons not to run these steps on this rig, a sentence each."""
    plan = tuple(plan)
    ceilings = [rig.motor.max_speed] if rig.motor else []
    ceilings += [rig.limits.overspeed] if rig.limits else []
    fastest = max((step.to for step in plan if isinstance(step, Ramp)), default=0.0)
    if ceilings and fastest >= min(ceilings):
        yield f"goes to {fastest * RPM:.0f} rpm, want less than the limit of {min(ceilings) * RPM:.0f} rpm"
    if objection := _ramp_objection(rig.motor, {step.rate for step in plan if isinstance(step, Ramp)}):
        yield objection
    speeds = set()
    for _, speed, band in dwells_in_bands(plan, critical_bands(rig.limits, criticals)):
        if speed not in speeds:
            yield f"holds {speed * RPM:.0f} rpm inside the critical band {band}, want it to pass"
            speeds.add(speed)


def _keeps_ramp(motor: Motor | None) -> TypeGuard[ModbusRtu | ModbusTcp]:
    return isinstance(motor, ModbusRtu | ModbusTcp) and motor.keeps_ramp


def _settle_at_own_rate(plan: Sequence[Step]) -> Iterator[Step]:
    """Yield a plan whose settling ramps have the rate of its other ramps, for a drive that keeps one rate."""
    own = next((step.rate for step in plan if isinstance(step, Ramp) and step.rate != SETTLING_RAMP), SETTLING_RAMP)
    for step in plan:
        yield replace(step, rate=own) if isinstance(step, Ramp) and step.rate == SETTLING_RAMP else step


def _ramp_objection(motor: Motor | None, rates: Set[float]) -> str:
    """Return the reason not to run ramps at these rates [rad/s^2]; "": none."""
    if not _keeps_ramp(motor):
        return ""
    listed = " and ".join(f"{rate * RPM:.4g}" for rate in sorted(rates))
    if len(rates) > 1:
        return f"ramps at {listed} rpm/s, want one rate: a drive of profile {motor.profile} keeps it while it turns"
    if motor.ramp and any(abs(rate / motor.ramp - 1) > SAME_RAMP for rate in rates):
        return f"ramps at {listed} rpm/s, want the {motor.ramp * RPM:.4g} rpm/s of motor.ramp, which is set by hand"
    return ""


def _generate(plan: Plan, rig: RigConfig, bands: Sequence[Band]) -> Iterator[Step]:
    match plan:
        case RunUpCoastDown():
            return run_up_coast_down(plan)
        case RunUpRampDown():
            return run_up_ramp_down(plan)
        case Stepped():
            return stepped_speeds(plan, avoid=bands)
        case DwellAt():
            return single_dwell(plan)
        case TrialMassRuns():
            return trial_mass_runs(plan.masses, tuple(_generate(rig.plans[plan.plan], rig, bands)))
        case _:
            assert_never(plan)
