"""Asked against measured speed: no turn may be faster than the ramp asked for.

Slower is allowed here: a drive may have a gentler ramp of its own, an induction motor slips. Faster is a drive set for
a motor of fewer poles, one that takes its speed from elsewhere, or has lost control. A plan's steps find the rest, when
they are due: a ramp that does not arrive, a dwell that strays.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.probes import KeyphasorSpeed

FASTER = 1.2  # of the speed asked for: an S-shaped ramp is 10 % ahead of a straight one, overshoot may be as much
FASTER_BY = 2.0  # rad/s, 19 rpm beyond that: cogging near standstill
ENOUGH_TURNS = 3  # of the last five: a stray pulse makes two of them too short
FIRST_TURNS = 2  # while fewer than five are known: these, the last ones


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A speed asked of the drive."""

    speed: float  # rad/s; 0: a stop
    ramp: float  # rad/s^2
    at: float  # s of the sample clock
    start: float  # rad/s, the most the rotor had then

    @property
    def rises(self) -> bool:
        """True if the speed is to rise, or stay."""
        return 0 < self.speed >= self.start

    @property
    def ramp_ends(self) -> float:
        """Sample time [s] at which the ramp should be over."""
        return self.at + (abs(self.speed - self.start) / self.ramp if self.ramp else 0.0)

    def most(self, t: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Return the greatest speed [rad/s] asked for at times `t` [s]; a falling ramp may take as long as it likes."""
        if not self.rises:
            return np.full_like(t, self.start)
        return np.clip(self.start + self.ramp * (np.asarray(t) - self.at), self.start, self.speed)

    def allows(self, t: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Return the speed [rad/s] above which the rotor is faster than asked for at times `t` [s]."""
        return FASTER * self.most(t) + FASTER_BY


class AskedSpeed:
    """The last command, and the turns since then."""

    def __init__(self) -> None:
        self.command: Command | None = None  # None: nothing was asked for
        self._pulses = 0  # of the keyphasor when it was last looked at

    def ask(self, speed: float, *, ramp: float, keyphasor: KeyphasorSpeed) -> None:
        """Take a command at its sending: the drive cannot obey earlier, so the rotor is never ahead of it."""
        before, start = self.command, keyphasor.steady_speed
        if before and before.rises:  # what is measured lags behind a rising ramp
            start = max(start, float(before.most(keyphasor.time)))
        self.command = Command(speed=speed, ramp=ramp, at=keyphasor.time, start=start)

    def check(self, keyphasor: KeyphasorSpeed) -> None:
        """Compare the last turns with the command. Raises LimitExceeded."""
        if self.command is None or keyphasor.pulses == self._pulses:
            return
        self._pulses = keyphasor.pulses
        ends = keyphasor.turns
        middles, speeds = (ends[1:] + ends[:-1]) / 2, 2 * math.pi / np.diff(ends)
        faster = (middles > self.command.at) & (speeds > self.command.allows(middles))
        full = len(faster) >= 2 * ENOUGH_TURNS - 1
        if (faster.sum() >= ENOUGH_TURNS) if full else (len(faster) >= FIRST_TURNS and faster[-FIRST_TURNS:].all()):
            asked = self.command.most(middles)[faster][-1]
            raise LimitExceeded(
                f"speed: the rotor turns at {speeds[faster][-1] * RPM:.0f} rpm, at most {asked * RPM:.0f} rpm were "
                "asked for by then; do rpm per Hz, gear or pole pairs of [motor] fit the drive?"
            )
