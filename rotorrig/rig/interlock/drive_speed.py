"""Drive's speed against the keyphasor's: a wrong number of pole pairs, or gear, makes them differ by a factor.

The speeds the drive reports are summed up over each turn the keyphasor has timed: that makes one turn, less an
induction motor's slip. On a ramp the two clocks need not agree to better than a third of the time since its start.
"""

import math
from collections import deque

import numpy as np

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import KeyphasorSpeed

FACTOR = 1.6  # between the two; one pole pair instead of two is 2, two instead of three 1.5, slip at most 1.1
TURNS = 2  # in succession: the first one from standstill may begin late
READINGS_APART = 0.6  # s at most, else what the drive did between them is not known; they are taken every 0.25 s
KEPT = 40  # readings


class DriveSpeed:
    """The drive's readings since it was last sent off, each with its sample time."""

    def __init__(self) -> None:
        self._readings: deque[tuple[float, float]] = deque(maxlen=KEPT)  # (s, rad/s)
        self._judged = 0.0  # s, end of the last turn looked at

    def forget(self) -> None:
        """Start afresh: the drive is off, stops, or has got another command."""
        self._readings.clear()

    def check(self, state: MotorState, keyphasor: KeyphasorSpeed, *, most: float) -> None:
        """Take a reading of a drive whose speed is to rise or stay, now to `most` [rad/s]. Raises LimitExceeded."""
        if not (state.running and 0 < state.speed <= most):  # it says nothing, or its setpoint
            self.forget()
            return
        self._readings.append((keyphasor.time, state.speed))
        ends = keyphasor.turns[-TURNS - 1 :]
        if len(ends) <= TURNS or ends[-1] <= self._judged:
            return
        times, speeds = np.array(self._readings).T
        first = int(np.searchsorted(times, ends[0], side="right")) - 1  # the reading before the turns
        if first < 0 or np.diff(times[first:]).max(initial=0.0) > READINGS_APART:
            return
        self._judged = float(ends[-1])
        angle = np.concatenate(([0.0], np.cumsum(np.diff(times) * (speeds[1:] + speeds[:-1]) / 2)))
        believed = np.diff(np.interp(ends, times, angle)) / (2 * math.pi)  # turns, where the keyphasor has one each
        if (believed > FACTOR).all() or (believed < 1 / FACTOR).all():
            last = 2 * math.pi / (ends[-1] - ends[-2])
            raise LimitExceeded(
                f"speed: the rotor turns at {last * RPM:.0f} rpm, the drive reports {believed[-1] * last * RPM:.0f} "
                "rpm for the same turn; do rpm per Hz, gear or pole pairs of [motor] fit the drive?"
            )
