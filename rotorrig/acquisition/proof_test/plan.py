"""Plan of a proof test's part: to slow roll, and steady there."""

import math

from rotorrig.acquisition.sweep import SETTLING_RAMP, Dwell, Ramp, Step, objections
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, ModbusRtu, ModbusTcp, RigConfig

SPEED = 300 / RPM  # rad/s, where no plan has a slow roll ...
SHARE = 0.25  # ... or, of a slow motor, so much of its greatest speed
SETTLING = 1.0  # s
STEADY_SECONDS, STEADY_TURNS = 3.0, 10  # for which the rotor is measured before anything is done to it


def plan_proof_test(rig: RigConfig) -> tuple[Step, ...]:
    """Return the steps that lead to the steady rotor. Raises ConfigError if the rig's limits forbid them."""
    if rig.motor is None or rig.daq is None or rig.keyphasor is None:
        missing = next(name for name in ("motor", "daq", "keyphasor") if getattr(rig, name) is None)
        raise ConfigError(f"{missing}: is missing in the config of '{rig.name}', want [{missing}] for a proof test")
    speed = proof_speed(rig)
    steps = (Ramp(to=speed, rate=_ramp(rig)), Dwell(seconds=SETTLING), Dwell(seconds=steady_seconds(speed)))
    for objection in objections(rig, steps):
        raise ConfigError(f"proof test: {objection}")
    return steps


def proof_speed(rig: RigConfig) -> float:
    """Return the speed [rad/s] at which protections are provoked: the slow roll of the default plan, or of another."""
    assert rig.motor
    plans = [rig.plans[name] for name in sorted(rig.plans, key=lambda name: name != "default")]
    slow_rolls = [speed for plan in plans if (speed := getattr(plan, "slow_roll", None))]
    return float(slow_rolls[0]) if slow_rolls else min(SPEED, SHARE * rig.motor.max_speed)


def steady_seconds(speed: float) -> float:
    """Return for how long [s] the rotor is measured at a speed [rad/s] before anything is done to it."""
    return max(STEADY_SECONDS, STEADY_TURNS * math.tau / speed)


def _ramp(rig: RigConfig) -> float:
    """Return the ramp [rad/s^2]: the one that is set at the drive by hand, else a gentle one."""
    by_hand = rig.motor.ramp if isinstance(rig.motor, ModbusRtu | ModbusTcp) else None
    return by_hand or SETTLING_RAMP
