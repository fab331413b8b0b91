"""Drive's speed against the keyphasor's: a wrong number of pole pairs, or gear, makes them differ by a factor.

Turns the keyphasor has timed are compared with the lowest and the highest speed the drive reported about then: on a
ramp the two are not taken at the same moment.
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import KeyphasorSpeed

FACTOR = 1.6  # between the two; one pole pair instead of two is 2, two instead of three 1.5, slip at most 1.1
TURNS = 2  # in succession: the first one from standstill may begin late
OFFSET = 0.25  # s by which a reading may be older or newer than the samples it came with
READINGS_APART = 0.6  # s at most, else what the drive did between them is not known; they are taken every 0.25 s
KEPT = 40  # readings


@dataclass(frozen=True, slots=True)
class _Turns:
    """Turns in succession: when [s], and the slowest and the fastest of them [rad/s]."""

    begin: float
    end: float
    slowest: float
    fastest: float


class DriveSpeed:
    """The drive's readings since it was last sent off, each with its sample time, and the turns to be compared."""

    def __init__(self) -> None:
        self._readings: deque[tuple[float, float]] = deque(maxlen=KEPT)  # (s, rad/s)
        self._turns: deque[_Turns] = deque()  # waiting for the readings after them

    def forget(self) -> None:
        """Start afresh: the drive is off, stops, or has got another command."""
        self._readings.clear()
        self._turns.clear()

    def check(self, state: MotorState, keyphasor: KeyphasorSpeed, *, most: float) -> None:
        """Take a reading of a drive whose speed is to rise or stay, now to `most` [rad/s]. Raises LimitExceeded."""
        if not (state.running and 0 < state.speed <= most):  # it says nothing, or its setpoint
            self.forget()
            return
        now = keyphasor.time
        self._readings.append((now, state.speed))
        ends = keyphasor.turns[-TURNS - 1 :]
        if len(ends) > TURNS:
            speeds = 2 * math.pi / np.diff(ends)
            self._turns.append(_Turns(ends[0], ends[-1], speeds.min(), speeds.max()))
        while self._turns and self._turns[0].end + OFFSET <= now:
            self._compare(self._turns.popleft())

    def _compare(self, turns: _Turns) -> None:
        times, speeds = np.array(self._readings).T
        first = int(np.searchsorted(times, turns.begin - OFFSET, side="right")) - 1
        last = int(np.searchsorted(times, turns.end + OFFSET))
        if first < 0 or np.diff(times[first : last + 1]).max() > READINGS_APART:
            return
        low, high = speeds[first : last + 1].min(), speeds[first : last + 1].max()
        if low > FACTOR * turns.fastest or high < turns.slowest / FACTOR:
            raise LimitExceeded(
                f"speed: the rotor turns at {turns.fastest * RPM:.0f} rpm, the drive reports {low * RPM:.0f} to "
                f"{high * RPM:.0f} rpm; do rpm per Hz, gear or pole pairs of [motor] fit the drive?"
            )
