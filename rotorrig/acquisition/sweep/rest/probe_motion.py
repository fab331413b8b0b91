"""Whether the probes see the rotor move: their noise before it turns, their 1X while it does, what moves afterwards.

Only what goes round with the keyphasor counts as the rotor's motion at speed: what the drive's inverter induces ends
with the inverter, not with the rotation.
"""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo, ProbeScale

STILL_SECONDS = 8.0  # of samples, four turns at 30 rpm, in which a probe has to see nothing move
TURN_SECONDS = 2.0  # of one of these turns
SIGNIFICANT = 5.0  # standard errors of the 1X, from which on a probe sees the rotor turn
REGULAR = 1.5  # the longest turn over the shortest: beyond that, the keyphasor is not to be believed
GONE = 0.5  # of the least 1X seen, which everything that moves at rest has to stay below ...
FLOOR = 2.0  # ... and so many times the noise before the start
DETAIL = 2000.0  # Hz, rate to which the samples are thinned out


class ProbeMotion:
    """The probes' samples of the last seconds, the noise and the least 1X of each."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._scale = ProbeScale.of(rig, info)
        self._rate = info.sample_rate
        self._group = max(1, round(info.sample_rate / DETAIL))  # samples made one
        self._kept: deque[NDArray[np.float64]] = deque()  # (sample, probe), m, thinned out
        self._length = 0  # samples in it
        self._next_sample = 0
        self._least = np.full(len(rig.probes), np.inf)  # (probe,) least 1X [m], 0-peak; infinite: not measured
        self._floor = np.full(
            len(rig.probes), np.inf
        )  # (probe,) noise at rest [m], sqrt(2) rms; infinite: not measured

    def take(self, block: Block) -> None:
        """Keep the next block, thinned out by means of neighbours."""
        self._next_sample = block.first_sample + len(block.counts)
        rows = len(block.counts) // self._group
        if not rows:
            return
        counts = block.counts[: rows * self._group, self._scale.channels].reshape(rows, self._group, -1)
        self._kept.append(counts.mean(axis=1) * self._scale.gain)
        self._length += rows
        while self._length - len(self._kept[0]) >= STILL_SECONDS * self._thinned_rate:
            self._length -= len(self._kept.popleft())

    def forget(self) -> None:
        """Drop the samples kept: some that should follow are missing."""
        self._kept.clear()
        self._length = 0

    def measure_floor(self) -> None:
        """Measure each probe's noise, over what is kept of a rotor at rest."""
        if self._length:
            self._floor = self._strongest_motion()

    def measure_1x(self, turns: NDArray[np.float64]) -> None:
        """Measure each probe's 1X over whole turns, whose ends are at these times [s] of the sample clock.

        A probe whose 1X does not stand out of the rest of its signal does not see the rotor at every speed.
        """
        end = self._next_sample / self._rate
        first = self._length - math.ceil((end - turns[0]) * self._thinned_rate)
        lengths = np.diff(turns)
        if first < 0 or lengths.max() > REGULAR * lengths.min():
            return
        signal = np.concatenate(self._kept)[first:]
        times = end - (len(signal) - 0.5 - np.arange(len(signal))) / self._thinned_rate
        inside = (times >= turns[0]) & (times <= turns[-1])
        angle = 2 * np.pi * np.interp(times[inside], turns, np.arange(len(turns)))
        columns = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle), np.linspace(-1, 1, len(angle))])
        if len(columns) <= 2 * columns.shape[1]:
            return
        fitted, *_ = np.linalg.lstsq(columns, signal[inside], rcond=None)
        noise = (signal[inside] - columns @ fitted).std(axis=0)
        amplitude = np.hypot(*fitted[:2])
        seen = amplitude > SIGNIFICANT * noise * math.sqrt(2 / len(columns))
        self._least = np.minimum(self._least, np.where(seen, amplitude, 0.0))

    def sees_nothing_move(self) -> bool:
        """Return whether a probe that saw the rotor turn sees nothing of it any more, for long enough."""
        if self._length < STILL_SECONDS * self._thinned_rate - 1:
            return False
        moving, measured = self._strongest_motion(), np.isfinite(self._least)
        still = (moving < GONE * self._least) & (moving < FLOOR * self._floor)
        return bool(np.any(measured & still & (moving > 0)))

    def _strongest_motion(self) -> NDArray[np.float64]:
        """Return sqrt(2) rms [m] of each probe, (probe,), in the turn's time at 30 rpm in which it moves most."""
        signal = np.concatenate(self._kept)
        time = np.linspace(-1.0, 1.0, len(signal))
        signal = signal - signal.mean(axis=0) - np.outer(time, time @ signal / (time @ time))
        pieces = np.array_split(signal, max(1, round(len(signal) / (TURN_SECONDS * self._thinned_rate))))
        return np.max([np.sqrt(2) * piece.std(axis=0) for piece in pieces], axis=0)

    @property
    def _thinned_rate(self) -> float:
        return self._rate / self._group
