"""Edges of a pulse train: threshold crossings, found piece by piece, so that a long recording takes little memory.

Two passes: `LevelFinder` takes the samples for the levels between which the pulses go, `EdgeFinder` takes them again
for the crossings. What they find does not depend on how the samples are cut into pieces.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from rotorrig.rig import DataError

SPIKES = 0.001  # share of the samples at either end that may be spikes; a pulse has to last longer
SEPARATION = 3.0  # levels apart, in scatter about them: 2.3 for pure noise, 3.8 for a sine, > 10 for a pulse
STRETCH = 4.0  # s: what levels are found in, two pulses of a slow roll at 30 rpm
PICKED = 10_000  # samples of a stretch that are looked at
AT_REST = 0.5  # of the largest swing: stretches with less hold hum, no pulses
DRIFT = 0.05  # of the swing: levels that wander by less are taken as steady
NEIGHBOURS = 5  # stretches in the running median of levels that wander


@dataclass(frozen=True, slots=True, kw_only=True)
class Levels:
    """Low and high level of a pulse train, steady or wandering."""

    sample: NDArray[np.float64]  # (stretch,) middle of each stretch
    low: NDArray[np.float64]  # (stretch,) V
    high: NDArray[np.float64]  # (stretch,) V

    @property
    def lowest_high(self) -> float:
        """The high level where it is lowest [V]."""
        return float(self.high.min())

    @property
    def highest_low(self) -> float:
        """The low level where it is highest [V]."""
        return float(self.low.max())

    def middle(self, first_sample: int, count: int) -> float | NDArray[np.float64]:
        """Return the voltage midway between the levels, of each of `count` samples (sample,) or, if steady, of all."""
        middle = (self.low + self.high) / 2
        if len(middle) == 1:
            return float(middle[0])
        return np.interp(np.arange(first_sample, first_sample + count), self.sample, middle)


class LevelFinder:
    """Finder of the levels, stretch by stretch; a stretch without pulses takes them from its neighbours."""

    def __init__(self, rate: float, *, where: str = "keyphasor") -> None:
        """Take samples at `rate` [1/s]."""
        self._length = max(round(STRETCH * rate), 1)
        self._where = where
        self._pieces: list[NDArray[np.float64]] = []
        self._held = 0
        self._next = 0
        self._found: list[tuple[float, float, float]] = []
        self._nothing: DataError | None = None

    def take(self, first_sample: int, volts: NDArray[np.float64]) -> None:
        """Take the next samples, (sample,) V, of which the first has index `first_sample`."""
        self._next = first_sample
        while len(volts):
            part, volts = np.split(volts, [self._length - self._held])
            self._pieces.append(part)
            self._held += len(part)
            self._next += len(part)
            if self._held == self._length:
                self._close()

    def levels(self) -> Levels:
        """Return the levels of all samples taken. Raises DataError if none held two levels."""
        if self._held >= self._length / 2 or (self._held and not self._found):
            self._close()
        if not self._found:
            raise self._nothing or DataError(f"{self._where}: no samples, want a pulse once per turn")
        sample, low, high = np.array(self._found).T
        pulsing = high - low > AT_REST * np.max(high - low)
        sample, low, high = sample[pulsing], low[pulsing], high[pulsing]
        usual_low, usual_high = np.median(low), np.median(high)
        wander = np.maximum(np.abs(low - usual_low), np.abs(high - usual_high))
        if np.median(wander) < DRIFT * (usual_high - usual_low):
            return Levels(sample=sample[:1], low=np.array([usual_low]), high=np.array([usual_high]))
        low, high = (median_filter(level, NEIGHBOURS, mode="nearest") for level in (low, high))
        return Levels(sample=sample, low=low, high=high)

    def _close(self) -> None:
        volts = np.concatenate(self._pieces)
        middle = self._next - len(volts) / 2
        if len(volts) > PICKED:  # at random, for regular steps may keep pace with the pulses; always the same ones
            volts = volts[np.random.default_rng(0).integers(0, len(volts), PICKED)]
        try:
            self._found.append((middle, *levels(volts, where=self._where)))
        except DataError as error:
            self._nothing = error
        self._pieces, self._held = [], 0


class EdgeFinder:
    """Finder of the chosen edges of a pulse train.

    A crossing counts when the voltage has left the band about the threshold on one side and then on the other; of
    several in between the last one does. Its place is interpolated linearly between the two samples about it.

    >>> volts = np.array([0.0, 0, -4, -8, -8, 0, 0])
    >>> EdgeFinder(edge="falling", band=2.0).take(0, volts, threshold=-5.0)
    array([2.25])
    """

    def __init__(self, *, edge: str, band: float) -> None:
        """Look for the "falling" or "rising" `edge`, beyond a band of `band` volts about the threshold."""
        self._sign = 1.0 if edge == "rising" else -1.0
        self._band = band
        self._next = -1  # index of the sample after those taken
        self._last = np.nan  # the voltage before the next sample
        self._crossing = np.nan  # the last crossing
        self._above = True  # the side the voltage was last on, beyond the band

    def take(
        self, first_sample: int, volts: NDArray[np.float64], *, threshold: float | NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the edges (edge,), in fractional samples, completed by the next samples (sample,) [V].

        `threshold` [V] may be one per sample. After a gap in the indices nothing before it is known.
        """
        if first_sample != self._next:
            self._forget()
        self._next = first_sample + len(volts)
        if len(volts) == 0:
            return np.empty(0)
        v = np.append(self._last, self._sign * (volts - threshold))  # the sample before comes first
        first_sample -= 1
        after = np.flatnonzero((v[:-1] < 0) & (v[1:] >= 0)) + 1
        places = np.append(self._crossing, first_sample + after - v[after] / (v[after] - v[after - 1]))
        outside = np.flatnonzero(np.abs(v[1:]) > self._band / 2) + 1
        above = np.append(self._above, v[outside] > 0)
        crossed = outside[above[1:] & ~above[:-1]]  # first sample beyond the band on the far side
        self._last, self._crossing, self._above = float(v[-1]), float(places[-1]), bool(above[-1])
        return places[np.searchsorted(after, crossed, side="right")]

    def _forget(self) -> None:
        self._last, self._crossing, self._above = np.nan, np.nan, True


def levels(volts: NDArray[np.float64], *, where: str = "keyphasor") -> tuple[float, float]:
    """Return the low and high level [V] of a pulse train, flanks and spikes ignored.

    The fullest bin of the histogram's either half, then the median of the samples near it (IEEE Std 181, histogram
    modes). Raises DataError if the samples hold no two levels.
    """
    bottom, top = (float(level) for level in np.quantile(volts, [SPIKES, 1 - SPIKES]))
    volts = volts[(volts >= bottom) & (volts <= top)]
    upper = volts > (bottom + top) / 2
    halves = (volts[~upper], volts[upper])
    if not upper.any():
        raise DataError(f"{where}: no pulse found, the voltage stays at {top:.3g} V; want a pulse once per turn")
    low, high = (_mode(half, span=top - bottom) for half in halves)
    scatter = max(float(np.median(np.abs(half - level))) for half, level in zip(halves, (low, high), strict=True))
    if not high - low > SEPARATION * 1.4826 * scatter:
        raise DataError(
            f"{where}: no pulse found, the voltage wanders between {bottom:.3g} and {top:.3g} V; "
            "want a pulse once per turn"
        )
    return low, high


def _mode(volts: NDArray[np.float64], *, span: float) -> float:
    count, borders = np.histogram(volts, bins=50)
    middle = borders[np.argmax(count)] + (borders[1] - borders[0]) / 2
    return float(np.median(volts[np.abs(volts - middle) <= 0.05 * span]))
