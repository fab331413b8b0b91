"""Standstill before the start: a rotor that turns already is not this program's to drive."""

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import KeyphasorSpeed


def check_standstill(state: MotorState, keyphasor: KeyphasorSpeed | None) -> None:
    """Check that no whole turn was seen since the stream began, and that the drive is off. Raises LimitExceeded."""
    turning = keyphasor is not None and len(keyphasor.turns) > 1
    if not (turning or state.running):
        return
    if keyphasor is not None and turning:
        what = f"the rotor turns at {keyphasor.steady_speed * RPM:.0f} rpm"
    else:
        what = f"the drive runs, at {state.speed * RPM:.0f} rpm by its word,"
    raise LimitExceeded(f"start: {what} before the first command, want it at rest, or --rolling to take it over")
