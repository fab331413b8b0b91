"""Drive's speed against the keyphasor's: a wrong number of pole pairs, or gear, makes them differ by a factor.

Each of the last turns the keyphasor has timed is compared with the speed the drive reported on average over that turn,
for a turn a little earlier or later as well: on a ramp the two are not taken at the same moment. What the drive
reports has its dead time, its S-shaped or gentle ramp in it, so none of them is an error here.
"""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import KeyphasorSpeed

SLIP = 1.1  # at most, drive's speed to the rotor's
CATCHING_UP = 1.25  # a rotor that broke loose late, in its second turn
FACTOR = SLIP * CATCHING_UP  # 1.375; one pole pair instead of two is 2, two instead of three 1.5
TURNS = 2  # in succession: the first one from standstill may begin late, a missing pulse doubles one
OFFSET = 0.25  # s by which a reading may be older or newer than the samples it came with
SHIFTS = np.linspace(-OFFSET, OFFSET, 11)
READINGS_APART = 0.6  # s at most, else what the drive did between them is not known; they are taken every 0.25 s
KEPT = 40  # readings


class DriveSpeed:
    """The drive's readings since it was last sent off, each with its sample time, and the turns to be compared."""

    def __init__(self) -> None:
        self._readings: deque[tuple[float, float]] = deque(maxlen=KEPT)  # (s, rad/s)
        self._ends: deque[NDArray[np.float64]] = deque()  # of turns in succession, s, waiting for the readings after

    def forget(self) -> None:
        """Start afresh: the drive is off, stops, or has got another command."""
        self._readings.clear()
        self._ends.clear()

    def check(self, state: MotorState, keyphasor: KeyphasorSpeed, *, most: float) -> None:
        """Take a reading of a drive whose speed is to rise or stay, now to `most` [rad/s]. Raises LimitExceeded."""
        if not (state.running and 0 < state.speed <= most):  # it says nothing, or its setpoint
            self.forget()
            return
        now = keyphasor.time
        self._readings.append((now, state.speed))
        ends = keyphasor.turns[-TURNS - 1 :]
        if len(ends) > TURNS:
            self._ends.append(ends)
        while self._ends and self._ends[0][-1] + OFFSET <= now:
            self._compare(self._ends.popleft())

    def _compare(self, ends: NDArray[np.float64]) -> None:
        times, speeds = np.array(self._readings).T
        first = int(np.searchsorted(times, ends[0] - OFFSET, side="right")) - 1
        last = int(np.searchsorted(times, ends[-1] + OFFSET))
        if first < 0 or np.diff(times[first : last + 1]).max() > READINGS_APART:
            return
        turning = math.tau / np.diff(ends)
        reported = _mean_speeds(times, speeds, ends)
        low, high = reported.min(axis=0), reported.max(axis=0)
        if (low > FACTOR * turning).all() or (FACTOR * high < turning).all():
            raise LimitExceeded(
                f"speed: the rotor turns at {turning[-1] * RPM:.0f} rpm, the drive reports {low[-1] * RPM:.0f} to "
                f"{high[-1] * RPM:.0f} rpm; do rpm per Hz, gear or pole pairs of [motor] fit the drive?"
            )


def _mean_speeds(
    times: NDArray[np.float64], speeds: NDArray[np.float64], ends: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the mean speed reported over each turn, (shift, turn), with straight lines between the readings."""
    turned = np.concatenate([[0.0], np.cumsum((speeds[1:] + speeds[:-1]) / 2 * np.diff(times))])
    at = np.clip(ends + SHIFTS[:, None], times[0], times[-1])
    before = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    passed = at - times[before]
    slopes = np.diff(speeds) / np.diff(times)
    angles = turned[before] + speeds[before] * passed + slopes[before] * passed**2 / 2
    return np.diff(angles, axis=1) / np.diff(ends)
