"""Vectors while the samples arrive: one per turn and probe, good enough to watch, never to identify from.

A turn runs from one keyphasor edge to the next and its speed is taken as constant; there is no window and no slow-roll
compensation. On a 30 rpm/s ramp that costs less than 1 % of the amplitude; `rotor track` does it properly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.probes.calibration import ProbeScale
from rotorrig.rig.probes.keyphasor_speed import KeyphasorSpeed
from rotorrig.rig.units import RPM

KEPT_TURNS = 3  # of waveform, for the orbit and the time base
LONGEST_TURN = 2.0  # s; a shaft slower than 30 rpm has no orbit to show
POINT_TURNS = 8  # averaged into one point of the Bode plot
APART = 4.0  # rpm between points of the Bode plot
TURN_BACK = 12.0  # rpm against the trend before the direction is taken to have changed


@dataclass(frozen=True, slots=True, kw_only=True)
class Waveform:
    """The last few whole turns."""

    t: NDArray[np.float64]  # (sample,) s on the sample clock
    x: NDArray[np.float64]  # (sample, probe) m about the mean, towards the probe
    edges: NDArray[np.float64]  # (edge,) s


class LiveTracker:
    """Turns blocks into speed, 1X vectors per turn and the last turns' waveform."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._keyphasor = KeyphasorSpeed(rig, info)
        self._scale = ProbeScale.of(rig, info)
        self._rate = info.sample_rate
        self._next = 0
        self._first = 0  # sample index of the first one kept
        self._counts = np.empty((0, info.channels), dtype=np.int32)
        self._edges = np.empty(0)  # of the kept turns, sample indices with a fraction

    @property
    def speed(self) -> float:
        """Speed [rad/s], 0 at rest."""
        return self._keyphasor.steady_speed

    @property
    def time(self) -> float:
        """Sample clock at the end of the last block [s]."""
        return self._keyphasor.time

    def take(self, block: Block) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Take the next block; return speed [rad/s] (turn,) and raw 1X [m] (turn, probe) of the turns it ends."""
        if block.first_sample != self._next:
            self._first, self._counts, self._edges = block.first_sample, block.counts[:0], np.empty(0)
        self._next = block.first_sample + len(block.counts)
        self._counts = np.concatenate([self._counts, block.counts])
        known = len(self._edges)
        self._edges = np.concatenate([self._edges, self._keyphasor.update(block)])
        ended = self._turn_vectors(max(known - 1, 0))
        self._let_go()
        return ended

    def waveform(self) -> Waveform | None:
        """Return the last whole turns; None before the first."""
        edges = self._edges[-KEPT_TURNS - 1 :]
        if len(edges) < 2:
            return None
        begin, end = (int(np.ceil(edge)) - self._first for edge in edges[[0, -1]])
        x = self._scale.displacement(self._counts[begin:end])
        return Waveform(
            t=(self._first + np.arange(begin, end)) / self._rate, x=x - x.mean(axis=0), edges=edges / self._rate
        )

    def _turn_vectors(self, since: int) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Return speeds and vectors of the turns between the edges from index `since` on."""
        edges = self._edges[since:]
        if len(edges) < 2:
            return np.empty(0), np.empty((0, len(self._scale.channels)), dtype=complex)
        bounds = np.ceil(edges).astype(int) - self._first
        x = self._scale.displacement(self._counts[bounds[0] : bounds[-1]])
        index = np.arange(bounds[0], bounds[-1]) + self._first
        turn = np.repeat(np.arange(len(edges) - 1), np.diff(bounds))
        theta = 2 * np.pi * (index - edges[turn]) / np.diff(edges)[turn]
        starts, length = bounds[:-1] - bounds[0], np.diff(bounds)[:, None]
        about_mean = x - (np.add.reduceat(x, starts) / length)[turn]  # a turn is no whole number of samples
        turned_back = about_mean * np.exp(-1j * theta)[:, None]
        z = 2 * np.add.reduceat(turned_back, starts) / length
        return 2 * np.pi * self._rate / np.diff(edges), z.astype(np.complex128)

    def _let_go(self) -> None:
        """Keep the last turns, and no more than the longest turn while there is no edge."""
        self._edges = self._edges[-KEPT_TURNS - 1 :]
        oldest = self._next - int(LONGEST_TURN * KEPT_TURNS * self._rate)
        self._edges = self._edges[self._edges >= oldest]
        begin = int(self._edges[0]) if len(self._edges) else self._next - 1
        self._counts = self._counts[max(begin - self._first, 0) :]
        self._first = max(begin, self._first)


class GrowingBode:
    """Collects turns into points of a Bode plot, apart in speed and sorted into rising and falling."""

    def __init__(self) -> None:
        self.direction = 1
        self.points: dict[int, list[tuple[float, NDArray[np.complex128]]]] = {1: [], -1: []}  # rpm, z (probe,) m
        self._waiting: list[tuple[float, NDArray[np.complex128]]] = []
        self._furthest = 0.0  # rpm, in the present direction

    def add(self, omega: NDArray[np.float64], z: NDArray[np.complex128]) -> bool:
        """Add turns (turn,), (turn, probe); return whether the plot has grown."""
        grown = False
        for speed, vector in zip(omega * RPM, z, strict=True):
            self._waiting.append((float(speed), vector))
            if len(self._waiting) == POINT_TURNS:
                grown |= self._point()
        return grown

    def arrays(self, direction: int) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Return rpm (point,) and z (point, probe) [m] of one direction, in the order of measurement."""
        rpm, z = [p[0] for p in self.points[direction]], [p[1] for p in self.points[direction]]
        return np.array(rpm), np.array(z)

    def _point(self) -> bool:
        rpm = float(np.mean([speed for speed, _ in self._waiting]))
        z = np.mean([vector for _, vector in self._waiting], axis=0)
        self._waiting.clear()
        if self.direction * (self._furthest - rpm) > TURN_BACK:
            self.direction, self._furthest = -self.direction, rpm
        elif self.direction * (rpm - self._furthest) > 0:
            self._furthest = rpm
        line = self.points[self.direction]
        if line and abs(line[-1][0] - rpm) < APART:
            return False
        line.append((rpm, z))
        return True
