"""Shaft speed while the samples arrive, from the keyphasor's pulses; for the interlock, the engine and live views.

A pulse edge is where the signal crosses the threshold, to a fraction of a sample by a straight line between the two
samples around it. After an edge the signal must go back past the threshold by half of the hysteresis, the width of the
band about the threshold, before the next one counts. Where there are several pulses per turn, a period is the time of
as many intervals, so uneven ones do no harm.

Results do not depend on how the stream is cut into blocks, with one exception: the automatic threshold is midway
between the extremes of the last seconds *so far*, hence known a block earlier or later.
"""

import math
from collections import deque
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.probes.calibration import channel_volts, check_channels

LEVELS_SECONDS = 2.0  # the extremes are looked for in this much signal: one pulse at least above 30 rpm
SMALLEST_PULSE = 2.0  # V between the extremes; less is noise (a proximity probe's notch gives 5 V and more)
HYSTERESIS = 0.4  # of the distance between the extremes
MEDIAN_TURNS = 5  # one stray or one missing pulse spoils two of them, the median none
MARK = 1.1  # times the next wider of a turn's intervals is the one before the pulse at angle zero


class KeyphasorSpeed:
    """Follows the keyphasor through a stream of Blocks."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        if rig.keyphasor is None:
            raise ConfigError("keyphasor: is missing in the config, want [keyphasor] with its channel")
        check_channels(rig, info)
        self.pulses = 0  # edges since the stream began
        self._channel = rig.keyphasor.channel
        self._sign = 1.0 if rig.keyphasor.edge == "falling" else -1.0  # a rising edge falls when turned over
        self._threshold = rig.keyphasor.threshold
        self._hysteresis = rig.keyphasor.hysteresis
        self._per_turn = rig.keyphasor.pulses_per_revolution
        self.info = info
        self._rate = info.sample_rate
        self._extremes: deque[tuple[int, float, float]] = deque()  # (last sample, lowest, highest) of each block
        self._next_sample = 0
        self._start = 0  # first sample of the stretch without gaps
        self._last_value: float | None = None  # the sample before the next block
        self._armed = False
        #: in samples, of the stretch without gaps
        self._edges: deque[float] = deque(maxlen=MEDIAN_TURNS * self._per_turn + 1)
        self._since_zero = 0  # edges since the one at angle zero
        self._period_before = math.inf  # s, of the last turns before the last gap; infinite: not known
        self._last_edge = 0.0  # sample, across gaps; 0: none yet

    @property
    def age(self) -> float:
        """Seconds of the sample clock since the last edge; since the stream or its last gap if there was none."""
        return (self._next_sample - (self._edges[-1] if self._edges else self._start)) / self._rate

    @property
    def silence(self) -> float:
        """Seconds of the sample clock since the last edge, or the first sample; unlike `age`, a gap counts as well."""
        return (self._next_sample - self._last_edge) / self._rate

    @property
    def last_edges(self) -> NDArray[np.float64]:
        """Sample times [s] of the last edges, five turns at most, none before a gap."""
        return np.array(self._edges) / self._rate

    @property
    def pulses_per_turn(self) -> int:
        """Edges in a turn."""
        return self._per_turn

    @property
    def time(self) -> float:
        """Seconds of the sample clock up to the end of the last block."""
        return self._next_sample / self._rate

    @property
    def turns(self) -> NDArray[np.float64]:
        """Ends of the last five whole turns and the beginning of the first, s of the sample clock, up to six values.

        Turns are counted back from the last edge, without gaps; empty before an edge.
        """
        return np.array(list(self._edges)[:: -self._per_turn][::-1]) / self._rate

    @property
    def last_speed(self) -> float:
        """Median speed [rad/s] of the last five turns, however long ago that was; 0 before a whole turn."""
        return 2 * math.pi / self._period(MEDIAN_TURNS)

    @property
    def speed(self) -> float:
        """Speed [rad/s] over the last turn, or what the wait for the next edge still allows; 0 before a whole turn.

        After a gap it is that of before the gap until there has been a whole turn.
        """
        return self._speed_over(1)

    @property
    def steady_speed(self) -> float:
        """Median speed [rad/s] of the last five turns: deaf to one stray or missing pulse, two turns late."""
        return self._speed_over(MEDIAN_TURNS)

    def update(self, block: Block) -> NDArray[np.float64]:
        """Take the next block; return its edges at angle zero as sample indices with a fraction, (turn,).

        With several pulses per turn angle zero is at the one after the widest interval, if that stands out, else at
        every n-th, which a stray or missing pulse shifts.
        """
        if block.first_sample != self._next_sample:
            self._restart_after_gap(block.first_sample)
        signal = self._sign * channel_volts(block.counts, channel=self._channel, info=self.info)
        self._next_sample = block.first_sample + len(signal)
        if not len(signal):
            return np.empty(0)
        self._note_extremes(signal)
        edges = self._find_edges(signal, block.first_sample)
        self._last_value = float(signal[-1])
        self.pulses += len(edges)
        if len(edges):
            self._last_edge = float(edges[-1])
        return np.array([edge for edge in edges.tolist() if self._is_zero(edge)])

    def _is_zero(self, edge: float) -> bool:
        """Take an edge; return whether it is the one at angle zero."""
        self._edges.append(edge)
        self._since_zero = (self._since_zero + 1) % self._per_turn
        if 1 < self._per_turn < len(self._edges):
            *others, last = self._last_intervals()
            if last > MARK * max(others):
                self._since_zero = 0
        return self._since_zero == 0

    def _speed_over(self, turns: int) -> float:
        return 2 * math.pi / max(self._period(turns), self.age * self._waits_per_turn())

    def _period(self, turns: int) -> float:
        """Return the median time of the last turns [s], each of as many intervals as there are pulses in a turn."""
        n = self._per_turn
        if len(self._edges) <= n:
            return self._period_before
        edges = np.array(self._edges)[-turns * n - 1 :]
        return float(np.median(edges[n:] - edges[:-n])) / self._rate

    def _waits_per_turn(self) -> float:
        """Return how often the longest wait for an edge goes into a turn, by the last one."""
        if len(self._edges) <= self._per_turn:
            return 1.0
        intervals = self._last_intervals()
        return sum(intervals) / max(intervals)

    def _last_intervals(self) -> list[float]:
        """Return the intervals [sample] of the last turn."""
        edges = list(self._edges)[-self._per_turn - 1 :]
        return [after - before for before, after in pairwise(edges)]

    def _restart_after_gap(self, first_sample: int) -> None:
        """Start afresh after a gap: a period across it would be a guess. Levels and speed are still good."""
        self._period_before = self._period(MEDIAN_TURNS)
        self._edges.clear()
        self._armed = False
        self._last_value = None
        self._start = first_sample

    def _note_extremes(self, signal: NDArray[np.float64]) -> None:
        self._extremes.append((self._next_sample, float(signal.min()), float(signal.max())))
        while self._extremes[0][0] < self._next_sample - LEVELS_SECONDS * self._rate:
            self._extremes.popleft()

    def _find_edges(self, signal: NDArray[np.float64], first_sample: int) -> NDArray[np.float64]:
        low, high = min(e[1] for e in self._extremes), max(e[2] for e in self._extremes)
        if high - low < SMALLEST_PULSE:
            return np.empty(0)
        threshold = (low + high) / 2 if self._threshold is None else self._threshold * self._sign
        if self._last_value is not None:
            signal, first_sample = np.concatenate([[self._last_value], signal]), first_sample - 1
        above = signal >= threshold
        crossings = np.flatnonzero(above[:-1] & ~above[1:])
        band = HYSTERESIS * (high - low) if self._hysteresis is None else self._hysteresis
        arming = np.flatnonzero(signal > threshold + band / 2)
        return first_sample + _interpolate(signal, self._keep_armed(crossings, arming), threshold)

    def _keep_armed(self, crossings: NDArray[np.intp], arming: NDArray[np.intp]) -> NDArray[np.intp]:
        """Keep the crossings that have an arming sample since the one before; carry the rest to the next block."""
        armed_by = np.searchsorted(arming, crossings, side="right")  # arming samples up to each crossing
        kept, used = [], 0
        for crossing, count in zip(crossings, armed_by, strict=True):
            if self._armed or count > used:
                kept.append(crossing)
            self._armed, used = False, int(count)
        self._armed = self._armed or len(arming) > used
        return np.array(kept, dtype=np.intp)


def _interpolate(signal: NDArray[np.float64], crossings: NDArray[np.intp], threshold: float) -> NDArray[np.float64]:
    """Return where a straight line between the samples at each crossing and the next meets the threshold."""
    before, after = signal[crossings], signal[crossings + 1]
    return crossings + (before - threshold) / (before - after)
