"""A probe's bracket, a mass on a spring upon a base that moves by a share of what the shaft does.

b'' + 2 zeta w b' + w^2 b = 2 zeta w u' + w^2 u for a base that moves by u (Thomson, Theory of Vibration with
Applications, 2nd ed. 1981, sec. 3.5). Solved exactly for a base that moves straight from sample to sample: the bracket
then moves with it, and what it is off by dies out as its free vibration.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


class Brackets:
    """The brackets of several probes; block after block as if in one."""

    def __init__(self, brackets: NDArray[np.float64], *, sample_rate: float) -> None:
        """Take `brackets` (probe, 3): share of the shaft's motion, Hz, damping ratio; of no share it does not move."""
        self._brackets = brackets
        self._h = 1.0 / sample_rate
        self._rest: NDArray[np.float64] | None = None
        self._state = np.zeros((3, len(brackets)))

    def move(self, towards: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by how much each bracket has moved (sample, probe) [m], for the shaft's motion towards its probe.

        Both count from where the shaft was at the first sample: then all stood still. An empty stretch compiles.
        """
        if self._rest is None and len(towards):
            self._rest = towards[0].copy()
        off = towards - (np.zeros(towards.shape[1]) if self._rest is None else self._rest)
        return _follow(off, self._brackets, self._h, self._state)


@njit(cache=True)
def _follow(towards: NDArray, brackets: NDArray, h: float, state: NDArray) -> NDArray:
    """Return the brackets' motion; `state` is the base's last place, the bracket's and its velocity, by probe."""
    moved = np.zeros_like(towards)
    for p in range(towards.shape[1]):
        share, hertz, ratio = brackets[p]
        if share == 0.0:
            continue
        w = math.tau * hertz
        decay, swing = ratio * w, w * math.sqrt(1.0 - ratio * ratio)
        e, c, s = math.exp(-decay * h), math.cos(swing * h), math.sin(swing * h)
        u, b, v = state[0, p], state[1, p], state[2, p]
        for i in range(len(towards)):
            slope = (share * towards[i, p] - u) / h
            off, rate = b - u, v - slope
            across = (rate + decay * off) / swing
            u = share * towards[i, p]
            b = u + e * (off * c + across * s)
            v = slope + e * ((across * swing - decay * off) * c - (off * swing + decay * across) * s)
            moved[i, p] = b
        state[0, p], state[1, p], state[2, p] = u, b, v
    return moved
