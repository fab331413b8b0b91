"""Sweeps as generators of steps: what to ask of the rig, in order.

`list(plan)` is a sweep's preview and its limit check; the engine runs the same steps.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rotorrig.rig.description import RigConfig, RunUpCoastDown
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.trial_mass import read_trial_mass
from rotorrig.rig.units import RPM


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramp:
    """Go to speed `to` [rad/s] at `rate` [rad/s^2] and wait until there."""

    to: float
    rate: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell:
    """Hold the speed for `seconds` of the sample clock."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Coast:
    """Power off; wait until the keyphasor says the speed is below `until` [rad/s]."""

    until: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Write `label` into the recording: "slow roll", "up", "down", which name the runs of a response."""

    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Write into the recording which trial mass is on the rotor: "disk: 12 g mm at 90 deg"."""

    mass: str


Step = Ramp | Dwell | Coast | Mark | Trial

SETTLING_RAMP = 10.0  # rad/s^2, about 95 rpm/s: gentle, and outside the recorded runs


def run_up_coast_down(plan: RunUpCoastDown) -> Iterator[Step]:
    """Yield a slow-roll dwell, a ramp from start to end, then a coast-down to the start speed."""
    yield Mark(label="settling")
    yield Ramp(to=plan.slow_roll, rate=SETTLING_RAMP)
    yield Dwell(seconds=1.0)
    yield Mark(label="slow roll")
    yield Dwell(seconds=plan.slow_roll_time)
    yield Mark(label="settling")
    yield Ramp(to=plan.start, rate=SETTLING_RAMP)
    yield Dwell(seconds=1.0)
    yield Mark(label="up")
    yield Ramp(to=plan.end, rate=plan.ramp)
    yield Dwell(seconds=1.0)
    yield Mark(label="down")
    yield Coast(until=plan.start)
    yield Mark(label="end")


def steps(rig: RigConfig, name: str = "default", *, trial: Sequence[str] = ()) -> tuple[Step, ...]:
    """Return the steps of the plan of that name, checked against the rig's limits. Raises ConfigError.

    `trial` are the trial masses on the rotor, as `read_trial_mass` reads them; they are noted first.
    """
    for mass in trial:
        read_trial_mass(mass, rig=rig)
    if name not in rig.plans:
        raise ConfigError(f"plan '{name}': the config has none of that name, want one of {sorted(rig.plans)}")
    plan = (*(Trial(mass=mass) for mass in trial), *run_up_coast_down(rig.plans[name]))
    ceilings = [rig.motor.max_speed] if rig.motor else []
    ceilings += [rig.limits.overspeed] if rig.limits else []
    fastest = max(step.to for step in plan if isinstance(step, Ramp))
    if ceilings and fastest >= min(ceilings):
        raise ConfigError(
            f"plans.{name}: goes to {fastest * RPM:.0f} rpm, want less than the limit of {min(ceilings) * RPM:.0f} rpm"
        )
    return plan
