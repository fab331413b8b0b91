"""Keyphasor lost: no pulse for some turns while the rotor turns, by the drive's word or by what was asked of it.

The drive's word alone is not enough: one that reports zero would switch this off. Time in which samples are missing
counts as silence.
"""

import math

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock.asked_speed import Command
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import KeyphasorSpeed

SILENT_TURNS = 5.0  # a keyphasor silent for so many turns ...
SILENT_SECONDS = 2.0  # ... and for this long is lost
RAMP_FACTOR = 2.0  # a drive's own ramp may be gentler by this than the one asked for


class KeyphasorLoss:
    """Silence of the keyphasor against the speed the rotor should have."""

    def __init__(self) -> None:
        self._turning_since: float | None = None  # keyphasor.time at which the drive was first seen to turn

    def check_motor(self, state: MotorState, keyphasor: KeyphasorSpeed) -> None:
        """Check that the keyphasor pulses while the drive reports a speed. Raises LimitExceeded."""
        if not state.running or state.speed <= 0:
            self._turning_since = None
            return
        if self._turning_since is None:
            self._turning_since = keyphasor.time
        silent = min(keyphasor.silence, keyphasor.time - self._turning_since)
        if silent > _patience(state.speed):
            raise LimitExceeded(
                f"keyphasor: no pulse for {silent:.1f} s while the drive reports {state.speed * RPM:.0f} rpm, "
                "want one every turn; check the probe and the coupling"
            )

    def check(self, command: Command | None, keyphasor: KeyphasorSpeed) -> None:
        """Check that the keyphasor pulses while the rotor should turn as asked. Raises LimitExceeded."""
        silent = keyphasor.silence
        if command is None or not command.speed or silent <= SILENT_SECONDS:
            return
        since = keyphasor.time - command.at
        turns = keyphasor.turns
        if command.start or (len(turns) > 1 and turns[-2] > command.at):  # it was turning, so it was seen to turn
            patience = _patience(min(command.speed, keyphasor.last_speed) if keyphasor.last_speed else command.speed)
        else:  # sent off from standstill, down a ramp that may be the drive's own
            patience = RAMP_FACTOR * (command.ramp_ends - command.at) + _patience(command.speed)
        if min(silent, since) > patience:
            raise LimitExceeded(
                f"keyphasor: no pulse for {silent:.1f} s, though the rotor was sent to {command.speed * RPM:.0f} rpm, "
                "want one every turn; check the probe, the coupling and whether the drive obeys"
            )


def _patience(speed: float) -> float:
    """Return the silence [s] that is allowed at a speed [rad/s]."""
    return max(SILENT_SECONDS, SILENT_TURNS * 2 * math.pi / speed)
