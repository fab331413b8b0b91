"""Real-time 1X tracking, one vector per turn and probe: good enough to watch, never to identify from.

A turn runs from one keyphasor edge to the next and its speed is taken as constant; there is no window. On a 30 rpm/s
ramp that costs less than 1 % of the amplitude; `rotor track` does it properly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.viewer.live.data.waveform import Waveform, at_equal_angles
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo, KeyphasorSpeed, ProbeScale

KEPT_TURNS = 8  # of waveform: a full spectrum's
KEPT_SECONDS = 6.0  # of it at most; a shaft slower than 10 rpm has no orbit to show
GAP_SECONDS = 0.2  # of a standing shaft, for its mean position


@dataclass(frozen=True, slots=True, kw_only=True)
class Turns:
    """Turns that have ended, in order."""

    t: NDArray[np.float64]  # (turn,) s on the sample clock, at the end
    omega: NDArray[np.float64]  # (turn,) rad/s
    z: NDArray[np.complex128]  # (turn, probe) m 0-peak, raw 1X
    gap: NDArray[np.float64]  # (turn, probe) m from where a probe reads its gap voltage, towards the probe


class LiveTracker:
    """Turns blocks into speed, 1X vectors and mean position per turn, and the last turns' waveform."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._keyphasor = KeyphasorSpeed(rig, info)
        self._scale = ProbeScale.of(rig, info)
        self._rate = info.sample_rate
        self._next = 0
        self._first = 0  # sample index of the first one kept
        self._counts = np.empty((0, info.channels), dtype=np.int32)
        self._edges = np.empty(0)  # of the kept turns, sample indices with a fraction
        self._newest = self._counts  # of the last block, for a shaft that stands

    @property
    def speed(self) -> float:
        """Speed [rad/s], 0 at rest."""
        return self._keyphasor.steady_speed

    @property
    def time(self) -> float:
        """Sample clock at the end of the last block [s]."""
        return self._keyphasor.time

    @property
    def gap(self) -> NDArray[np.float64]:
        """Mean position (probe,) [m] over the end of the last block; NaN before the first."""
        if not len(self._newest):
            return np.full(len(self._scale.names), np.nan)
        return self._scale.displacement(self._newest).mean(axis=0)

    def take(self, block: Block) -> Turns:
        """Take the next block; return the turns it ends."""
        if block.first_sample != self._next:
            self._first, self._counts, self._edges = block.first_sample, block.counts[:0], np.empty(0)
        self._next = block.first_sample + len(block.counts)
        self._counts = np.concatenate([self._counts, block.counts])
        self._newest = block.counts[-max(1, int(GAP_SECONDS * self._rate)) :]
        known = len(self._edges)
        self._edges = np.concatenate([self._edges, self._keyphasor.update(block)])
        ended = self._complete_turns(max(known - 1, 0))
        self._let_go()
        return ended

    def waveform(self) -> Waveform | None:
        """Return the last whole turns, up to KEPT_TURNS; None before the first."""
        edges = self._edges
        if len(edges) < 2:
            return None
        begin = max(int(edges[0]) - self._first, 0)
        end = int(np.ceil(edges[-1])) - self._first + 1
        x = self._scale.displacement(self._counts[begin:end])
        return Waveform(edges=edges / self._rate, x=at_equal_angles(x, first=float(self._first + begin), edges=edges))

    def _complete_turns(self, since: int) -> Turns:
        """Return the turns between the edges from index `since` on."""
        edges = self._edges[since:]
        probes = len(self._scale.channels)
        if len(edges) < 2:
            nothing = np.empty((0, probes))
            return Turns(t=np.empty(0), omega=np.empty(0), z=nothing.astype(complex), gap=nothing)
        bounds = np.ceil(edges).astype(int) - self._first
        x = self._scale.displacement(self._counts[bounds[0] : bounds[-1]])
        index = np.arange(bounds[0], bounds[-1]) + self._first
        turn = np.repeat(np.arange(len(edges) - 1), np.diff(bounds))
        theta = 2 * np.pi * (index - edges[turn]) / np.diff(edges)[turn]
        starts, length = bounds[:-1] - bounds[0], np.diff(bounds)[:, None]
        mean = np.add.reduceat(x, starts) / length
        turned_back = (x - mean[turn]) * np.exp(-1j * theta)[:, None]  # a turn is no whole number of samples
        z = 2 * np.add.reduceat(turned_back, starts) / length
        return Turns(
            t=edges[1:] / self._rate,
            omega=2 * np.pi * self._rate / np.diff(edges),
            z=z.astype(np.complex128),
            gap=mean,
        )

    def _let_go(self) -> None:
        """Keep the last turns, and no more than KEPT_SECONDS."""
        self._edges = self._edges[-KEPT_TURNS - 1 :]
        self._edges = self._edges[self._edges >= self._next - int(KEPT_SECONDS * self._rate)]
        begin = int(self._edges[0]) if len(self._edges) else self._next - 1
        self._counts = self._counts[max(begin - self._first, 0) :]
        self._first = max(begin, self._first)
