"""Turns of the rotor by the sample clock: when it began to slow down, and when it came to rest.

When it began is known from the keyphasor's pulses, to a turn or two. The last turn gives no pulse any more, so its end
is the last motion that the probes saw, 2 s after the last pulse at most: then the rotor was slower than 30 rpm. A gap
in the samples hides the turn it falls into.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.proof_test.last_motion import LastMotion
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo, KeyphasorSpeed

SLOWER = 0.02  # of the speed at least, by which a turn has to be slower than the steady ones ...
BEYOND_JITTER = 1.5  # ... and times what these stray by
AT_REST = 2.0  # s for a turn, 30 rpm: slower than that counts as rest


class TurnRecord:
    """Ends of all turns of a run."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._keyphasor, self._rate = KeyphasorSpeed(rig, info), info.sample_rate
        self._motion = LastMotion(rig, info)
        self._ends: list[float] = []  # s; NaN: samples are missing here
        self._next_sample = 0
        self._steady = math.nan  # s, a turn of the rotor before it was disturbed
        self._slow = math.nan  # s, a turn slower than these ever were

    def take(self, block: Block) -> None:
        """Take the next block."""
        if block.first_sample != self._next_sample and self._ends:
            self._ends.append(math.nan)
        self._next_sample = block.first_sample + len(block.counts)
        self._ends += (self._keyphasor.update(block) / self._rate).tolist()
        self._motion.take(block)

    @property
    def time(self) -> float:
        """Seconds of the sample clock up to the end of the last block."""
        return self._keyphasor.time

    @property
    def speed(self) -> float:
        """Median speed of the last turns, or what the wait for the next pulse still allows [rad/s]."""
        return self._keyphasor.steady_speed

    @property
    def silence(self) -> float:
        """Seconds since the last pulse."""
        return self._keyphasor.silence

    @property
    def turn(self) -> float:
        """Duration [s] of a steady turn, which is how well times are known; NaN before `settle`."""
        return self._steady

    def settle(self, *, seconds: float) -> None:
        """Take the turns of the last seconds as those of the steady rotor."""
        lengths = self._lengths(since=self.time - seconds)
        lengths = lengths[np.isfinite(lengths)]
        if not len(lengths):
            raise ValueError(f"no whole turn in the last {seconds:g} s, expected a rotor at a steady speed")
        self._steady = float(np.median(lengths))
        jitter = float(np.abs(lengths / self._steady - 1).max())
        self._slow = self._steady / (1 - min(max(SLOWER, BEYOND_JITTER * jitter), 0.5))

    def slowing_at(self) -> float:
        """Return the time [s] from which on every turn is slower than the steady ones; NaN: the last one is not.

        It is the moment at which a pulse of the steady rotor was overdue, late by two turns at most.
        """
        ends, slow = self._slow_turns()
        begin = float(ends[-1 - slow]) if len(ends) else math.nan
        return begin + self._slow if begin + self._slow <= self.time else math.nan

    def rest_at(self) -> float:
        """Return when [s] a rotor that is at rest came to it; NaN if it never turned."""
        ends = [end for end in self._ends if not math.isnan(end)]
        if not ends:
            return math.nan
        seen = self._motion.last_seen()
        return min(max(ends[-1], ends[-1] if math.isnan(seen) else seen), ends[-1] + AT_REST)

    def _lengths(self, *, since: float) -> NDArray[np.float64]:
        """Return the durations [s] of the turns that began since then, NaN of one with a gap."""
        ends = np.array(self._ends)
        lengths: NDArray[np.float64] = np.diff(ends)
        return lengths[~(ends[:-1] < since)]

    def _slow_turns(self) -> tuple[NDArray[np.float64], int]:
        """Return the ends of the turns [s], and how many of the last ones are slow without a break."""
        ends = np.array(self._ends)
        fast = np.flatnonzero(~(np.diff(ends) > self._slow))
        return ends, len(ends) - 1 - (int(fast[-1]) + 1 if len(fast) else 0) if len(ends) else 0
