"""Sense of rotation: at slow roll, what the probes see of the shaft goes round with it.

Run-out and bow are fixed in the shaft, so the 1X orbit of a pair of probes is forward: from x towards y, as the plan
turns. Backward, the drive's phases are exchanged, or the probes' cables. Only at a slow-roll speed of the config's
plans: between split critical speeds a sound rotor whirls backward. A spot that one probe alone sees adds as much
backward as forward, so nothing is said unless the orbit is clearly circular.
"""

import math
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Probe, RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.probes import Block, DaqInfo, ProbeScale

MARGIN = 1.1  # of the slow-roll speed
TURNS = 8  # for one verdict
CLEAR = 3.0  # times the other sense
SIGMAS = 5.0  # by the scatter from turn to turn
SMALLEST = 1e-6  # m, 0-peak; less may be a magnetic spot
SAME_PLANE = 1e-3  # m
CROSSED = 0.5  # sine of the angle between two probes, at least


class RotationSense:
    """Forward and backward 1X of every pair of crossed probes, turn by turn, at slow roll."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self._scale, self._rate = ProbeScale.of(rig, info), info.sample_rate
        rolls = [plan.slow_roll for plan in rig.plans.values() if hasattr(plan, "slow_roll")]
        self._pairs = [
            (i, j) for i, j in combinations(range(len(rig.probes)), 2) if _cross(rig.probes[i], rig.probes[j])
        ]
        self._angles = np.array([probe.angle for probe in rig.probes])
        self._fastest = MARGIN * max(rolls) if rolls and self._pairs else 0.0  # rad/s; 0: never at slow roll
        self._blocks: list[Block] = []  # since the last pulse at angle zero
        self._zero: float | None = None  # sample of that pulse
        self._turns: list[NDArray[np.complex128]] = []  # (pair, forward and backward) m, 0-peak

    def check(self, block: Block, zeros: NDArray[np.float64], *, speed: float) -> None:
        """Take a block, its pulses at angle zero [sample] and the speed [rad/s]. Raises LimitExceeded."""
        if not 0 < speed <= self._fastest:
            self._zero, self._blocks, self._turns = None, [], []
            return
        if self._blocks and block.first_sample != self._blocks[-1].first_sample + len(self._blocks[-1].counts):
            self._zero, self._blocks = None, []  # a gap
        self._blocks.append(block)
        for zero in zeros.tolist():
            if self._zero is not None:
                self._turns.append(self._orbit(self._zero, zero))
            self._zero = zero
        if len(zeros):
            self._blocks = [one for one in self._blocks if one.first_sample + len(one.counts) > zeros[-1]]
        if len(self._turns) >= TURNS:
            self._judge(np.array(self._turns))
            self._turns = []

    def _orbit(self, begin: float, end: float) -> NDArray[np.complex128]:
        """Return forward and backward 1X amplitude (pair, 2) [m] of the turn between two pulses [sample]."""
        first = self._blocks[0].first_sample
        counts = np.concatenate([block.counts for block in self._blocks])
        low, high = max(math.ceil(begin) - first, 0), math.ceil(end) - first
        turn = np.exp(-2j * math.pi * (np.arange(low, high) + first - begin) / (end - begin))
        z = 2 * (turn @ counts[low:high, self._scale.channels]) / (high - low) * self._scale.gain
        orbits = np.empty((len(self._pairs), 2), complex)
        for k, (i, j) in enumerate(self._pairs):
            a, b = self._angles[i], self._angles[j]
            # what a probe sees is x cos a + y sin a
            x, y = (z[i] * math.sin(b) - z[j] * math.sin(a), z[j] * math.cos(a) - z[i] * math.cos(b)) / np.sin(b - a)
            orbits[k] = (x + 1j * y) / 2, (x - 1j * y) / 2
        return orbits

    def _judge(self, turns: NDArray[np.complex128]) -> None:
        """Compare the senses of orbits (turn, pair, 2), averaged."""
        size = np.abs(turns.mean(axis=0))  # (pair, 2)
        sigma = np.std(turns, axis=0, ddof=1) / math.sqrt(len(turns))
        clear = size[:, ::-1] * CLEAR < size
        clear &= (size > SIGMAS * sigma) & (size > SMALLEST)
        forward, backward = clear.any(axis=0)
        if backward and not forward:
            k = int(np.argmax(clear[:, 1] * size[:, 1]))
            names = " and ".join(self._scale.names[i] for i in self._pairs[k])
            raise LimitExceeded(
                f"sense of rotation: at slow roll the orbit of probes {names} is backward, {size[k, 1] * 1e6:.1f} um "
                f"against {size[k, 0] * 1e6:.1f} um forward; does the rotor turn backward, or are probes exchanged?"
            )


def _cross(one: Probe, other: Probe) -> bool:
    return abs(one.position - other.position) < SAME_PLANE and abs(math.sin(one.angle - other.angle)) > CROSSED
