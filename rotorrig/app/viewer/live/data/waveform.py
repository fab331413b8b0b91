"""The waveform of the last whole turns at equal steps of shaft angle, for what is drawn of it while samples arrive.

A point is the mean of the waveform over its step of angle, every sample counted once: no aliasing to speak of, and an
amplitude at order n is n pi / POINTS of the way down a sinc, 0.2 % at 2X, 0.6 % at 4X.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

POINTS = 64  # per turn
THETA = 2 * np.pi * (np.arange(POINTS) + 0.5) / POINTS  # rad, the middle of each step


@dataclass(frozen=True, slots=True, kw_only=True)
class Waveform:
    """Whole turns, the last of them the newest."""

    edges: NDArray[np.float64]  # (turn + 1,) s on the sample clock
    x: NDArray[np.float64]  # (turn * POINTS, probe) m from where a probe reads its gap voltage, towards the probe

    @property
    def turns(self) -> int:
        """Number of turns."""
        return len(self.edges) - 1

    @property
    def omega(self) -> float:
        """Mean speed [rad/s]."""
        return 2 * np.pi * self.turns / float(self.edges[-1] - self.edges[0])

    @property
    def gap(self) -> NDArray[np.float64]:
        """Mean position (probe,) [m]."""
        return self.x.mean(axis=0)

    @property
    def about_mean(self) -> NDArray[np.float64]:
        """The waveform less its mean over all turns, (turn * POINTS, probe) [m]."""
        return self.x - self.gap

    def last(self, turns: int) -> "Waveform":
        """Return the last so many turns, all if there are fewer."""
        kept = min(turns, self.turns)
        return Waveform(edges=self.edges[-kept - 1 :], x=self.x[-kept * POINTS :])

    def by_turn(self) -> NDArray[np.float64]:
        """Return the waveform as (turn, POINTS, probe) [m]."""
        return self.x.reshape(self.turns, POINTS, -1)


def at_equal_angles(x: NDArray[np.float64], *, first: float, edges: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the means of `x` (sample, probe) over each step of angle, (turn * POINTS, probe).

    `first` is the index of the first sample and `edges` (turn + 1,) are in samples too; within a turn the speed is
    taken as constant. What lies outside the samples is as the nearest one.

    >>> ramp = np.arange(-2.0, 9.0)[:, None]  # a waveform that is its own sample index
    >>> at_equal_angles(ramp, first=-2, edges=np.array([0.0, 6.4]))[:3, 0].round(3)
    array([0.05, 0.15, 0.25])
    """
    places = np.arange((len(edges) - 1) * POINTS + 1) / POINTS
    borders = np.interp(places, np.arange(len(edges)), edges)
    integral = np.concatenate([np.zeros((1, x.shape[1])), np.cumsum((x[1:] + x[:-1]) / 2, axis=0)])
    at = np.clip(borders - first, 0.0, len(x) - 1.0)
    whole = np.minimum(at.astype(np.intp), len(x) - 2)
    part = (at - whole)[:, None]
    # the trapezium of the sample's own stretch, cut where the border lies
    upto = integral[whole] + part * (x[whole] + part * (x[whole + 1] - x[whole]) / 2)
    return np.diff(upto, axis=0) / np.diff(at)[:, None]
