"""Last motion that the probes saw: a rotor at rest shows each of them one spot of its surface."""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo, ProbeScale

STEP = 0.005  # s, whose samples are averaged
STILL = 1.0  # s at the end of the record, which say what rest looks like
SIGMAS = 6.0  # from their mean, which is motion


class LastMotion:
    """Samples of all probes over a run, thinned out."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._channels = ProbeScale.of(rig, info).channels
        self._rate, self._group = info.sample_rate, max(1, round(STEP * info.sample_rate))
        self._times: list[NDArray[np.float64]] = []
        self._means: list[NDArray[np.float64]] = []

    def take(self, block: Block) -> None:
        """Take the next block."""
        rows = len(block.counts) // self._group
        counts = block.counts[: rows * self._group, self._channels].reshape(rows, self._group, -1)
        self._means.append(counts.mean(axis=1))
        self._times.append((block.first_sample + np.arange(1, rows + 1) * self._group) / self._rate)

    def last_seen(self) -> float:
        """Return the time [s] at which a probe last saw something move, of a rotor that is at rest; NaN: none did."""
        times, counts = np.concatenate(self._times), np.concatenate(self._means)
        still = counts[times > times[-1] - STILL]
        moving = np.any(np.abs(counts - still.mean(axis=0)) > SIGMAS * still.std(axis=0), axis=1)
        return float(times[moving][-1]) if moving.any() else math.nan
