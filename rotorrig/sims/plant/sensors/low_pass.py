"""An analogue low-pass filter of second order, as Butterworth's: the anti-alias filter before a converter.

y'' / w^2 + sqrt(2) y' / w + y = u with the corner w = sqrt(2) / delay: low frequencies come late by the delay, whatever
they are, and at the corner they are weaker by sqrt(2) and later by a quarter turn. Solved exactly for a signal that is
straight from sample to sample: on u0 + s t the filter settles at u0 + s (t - delay), and what it is off by dies out as
exp(-w t / sqrt(2)) (Oppenheim and Willsky, Signals and Systems, 2nd ed. 1997, sec. 6.5).
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


class LowPass:
    """The filters of several channels; block after block as if in one."""

    def __init__(self, delay: NDArray[np.float64], *, sample_rate: float) -> None:
        """Delay column p by `delay[p]` [s] at low frequency; one without a delay passes as it is."""
        self._delay = delay
        self._h = 1.0 / sample_rate
        self._state: NDArray[np.float64] | None = None

    def filter(self, signal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the next block (sample, column) as it comes out; before the first sample it stood still.

        An empty block compiles.
        """
        if self._state is None and len(signal):
            self._state = np.stack([signal[0], signal[0], np.zeros_like(signal[0])])
        state = np.zeros((3, len(self._delay))) if self._state is None else self._state
        return _filter(np.ascontiguousarray(signal), self._delay, self._h, state)


@njit(cache=True)
def _filter(signal: NDArray, delay: NDArray, h: float, state: NDArray) -> NDArray:
    """Return the filtered block; `state` is the last sample in, the last out and its rate, by column."""
    out = np.empty_like(signal)
    for p in range(signal.shape[1]):
        if delay[p] == 0.0:
            out[:, p] = signal[:, p]
            continue
        decay = 1.0 / delay[p]  # w / sqrt(2), and as fast it swings
        e, c, s = math.exp(-decay * h), math.cos(decay * h), math.sin(decay * h)
        u, y, v = state[0, p], state[1, p], state[2, p]
        for i in range(len(signal)):
            slope = (signal[i, p] - u) / h
            settled = u - slope * delay[p]
            off, rate = y - settled, v - slope
            swing = rate / decay + off
            y = settled + slope * h + e * (off * c + swing * s)
            v = slope + e * decay * ((swing - off) * c - (swing + off) * s)
            u = signal[i, p]
            out[i, p] = y
        state[0, p], state[1, p], state[2, p] = u, y, v
    return out
