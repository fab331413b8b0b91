"""Critical speeds on a 1X curve: where it peaks, its half-power speeds, amplification factor and damping ratio.

Definitions: API RP 684, 2nd ed. (2005), SP6.8.2.1 and SP6.8.2.10, the same as those of API 617, 7th and 8th ed. The
standards are not public; clauses and constants were checked with what quotes them, the source of ROSS among it.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks, peak_prominences

Reals = NDArray[np.float64]

HALF_POWER = math.sqrt(0.5)  # of the peak: API rounds it to 0.707
STANDS_OUT = 10.0  # sigmas: what a peak rises above the valleys beside it; noise alone reaches half of that
SHARE = 0.05  # of its own height, likewise: what ripples less is no resonance
DECAYED = 3.0  # zeta omega t after which a free vibration is as good as gone: 5 % are left
NEAR_PEAK = 0.6  # of the way to half power: rows up to there say where the peak is, those from 0.86 of it up
FLANK = (0.7, 1.3)  # of that way: rows between say where the half-power speed is, 0.82 to 0.61 of the peak
FEWEST = 3  # rows above half power: with fewer, the peak is between them
CRITICALLY_DAMPED = 2.5  # amplification factor below which no margin is wanted


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertain:
    """A value and one standard deviation; NaN where the curve had none."""

    value: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Resonance:
    """A peak of 1X amplitude; None where the curve has no half-power speed on a side."""

    omega: Uncertain  # rad/s, the critical speed: where the amplitude peaks
    amplitude: Uncertain  # m, 0-peak, there
    lower: Uncertain | None  # rad/s, half-power speed below the peak
    upper: Uncertain | None  # rad/s, above it
    amplification: Uncertain | None  # amplification factor AF = omega / (upper - lower)
    damping: Uncertain | None  # damping ratio 1 / (2 AF)


def find_resonances(
    omega: Reals,
    z: NDArray[np.complex128],
    covariance: Reals | None = None,
    *,
    common: Reals | None = None,
    steps: NDArray[np.complex128] | None = None,
    rate: float = 0.0,
) -> tuple[Resonance, ...]:
    """Return the peaks of a curve, by rising speed; rows with NaN are passed over.

    `omega` (row,) [rad/s] in any order, `z` (row,) [m], `covariance` (row, 2, 2) [m^2] of (re z, im z), independent
    from row to row; None for a model's curve, which has no noise, and whose resonances have a sigma only by `steps`
    (row, step) [m]: what one standard deviation of each of its parameters, or of their combinations, changes. `common`
    (2, 2) [m^2] is what all measured rows share: that of the slow-roll vector taken from them. A peak rises above the
    valleys beside it by STANDS_OUT sigmas and by SHARE of its height; the end of a sweep is none.

    `rate` [rad/s^2] is that of the run, negative where the speed falls. The free vibration of a resonance just passed
    beats against the unbalance response; a peak met before it has decayed is left out, as it may be such a beat.

    For a single degree of freedom, 1 / amplitude^2 is a parabola over 1 / omega^2: peak and half-power speeds are read
    off straight lines and parabolas in these coordinates, through rows near the peak and near half power. The sigmas
    are of first order, from a step of one sigma in every row.
    """
    order = np.argsort(omega, kind="stable")
    known = np.isfinite(omega) & np.isfinite(z) & (omega > 0) & (z != 0)
    if covariance is not None:
        known &= np.isfinite(covariance).all(axis=(1, 2))
    order = order[known[order]]
    omega, z = omega[order], z[order]
    amplitude = np.abs(z)
    radial = np.stack([z.real, z.imag], axis=1) / amplitude[:, None]
    sigma = None if covariance is None else np.sqrt(np.einsum("ri,rij,rj->r", radial, covariance[order], radial))
    peaks = _peaks(amplitude, np.zeros(len(z)) if sigma is None else sigma)
    moved = [np.zeros((len(z), 0))]  # of the amplitude, in all rows at once, (row, step)
    if sigma is not None and common is not None:
        moved.append(radial @ _root(common))
    if steps is not None:
        moved.append((steps[order] * (z.conj() / amplitude)[:, None]).real)
        sigma = np.zeros(len(z)) if sigma is None else sigma
    shared = np.concatenate(moved, axis=1)
    valleys = [a + int(np.argmin(amplitude[a:b])) for a, b in pairwise(peaks)]
    found = []
    for peak, first, last in zip(peaks, [0, *valleys], [*valleys, len(z) - 1], strict=bool(peaks)):
        rows = slice(first, last + 1)
        mine = None if sigma is None else sigma[rows]
        found.append(_resonance(omega[rows], amplitude[rows], peak - first, mine, shared[rows]))
    return _without_beats([each for each in found if each], rate)


def required_margin(amplification: float, *, above: bool) -> float:
    """Return the separation margin that is wanted, relative to the operating speed.

    `above`: the critical speed is above the operating speed, else below. API RP 684, SP6.8.2.10: none where the
    response is critically damped; 17 (1 - 1 / (AF - 1.5)) %, at most 16 %, below the lowest operating speed; 10 % more,
    at most 26 %, above the highest.

    >>> required_margin(10.0, above=False), required_margin(2.4, above=True)
    (0.15, 0.0)
    >>> required_margin(40.0, above=False), required_margin(40.0, above=True)
    (0.16, 0.26)
    """
    if amplification < CRITICALLY_DAMPED:
        return 0.0
    margin = 0.17 * (1.0 - 1.0 / (amplification - 1.5))
    return min(0.26, 0.10 + margin) if above else min(0.16, margin)


def _without_beats(found: list[Resonance], rate: float) -> tuple[Resonance, ...]:
    """Return the peaks, by rising speed, without those that come before the free vibration of one before has decayed.

    It decays as exp(-zeta omega_c t), with t = |omega - omega_c| / |rate| since the peak.
    """
    kept: list[Resonance] = []
    for peak in found if rate > 0 else found[::-1]:
        passed = [(before, before.damping) for before in kept if rate]
        decays = [
            damping.value * before.omega.value * abs(peak.omega.value - before.omega.value) / abs(rate)
            for before, damping in passed
            if damping
        ]
        if all(decay > DECAYED for decay in decays):
            kept.append(peak)
    return tuple(sorted(kept, key=lambda peak: peak.omega.value))


def _peaks(amplitude: Reals, sigma: Reals) -> list[int]:
    """Return the rows of peaks that stand out of noise and of their own height."""
    found, _ = find_peaks(amplitude)
    rise, left, right = peak_prominences(amplitude, found)
    valley = np.where(amplitude[left] > amplitude[right], left, right)  # the higher one, from which the rise counts
    noise = np.hypot(sigma[found], sigma[valley])
    return found[(rise > STANDS_OUT * noise) & (rise > SHARE * amplitude[found])].tolist()


def _resonance(omega: Reals, amplitude: Reals, peak: int, sigma: Reals | None, common: Reals) -> Resonance | None:
    """Return the resonance at row `peak` of a curve that has no other, None where its rows make no parabola.

    `common` (row, step) are steps of all rows at once.
    """
    rows = _Rows.choose(omega, amplitude, peak, np.ones(len(omega)) if sigma is None else sigma)
    used, curve = rows.used(), amplitude[:, None]
    values = rows.read(curve[used])[:, 0]
    if not np.isfinite(values[:2]).all():
        return None
    spread = np.full(len(values), math.nan)
    if sigma is not None:
        steps = np.concatenate([np.diag(sigma[used]), common[used]], axis=1)  # (row, step)
        change = (rows.read(curve[used] + steps) - rows.read(curve[used] - steps)) / 2
        spread = np.sqrt(np.sum(np.square(change), axis=1))
    top, height, *rest = (
        Uncertain(value=float(v), sigma=float(s)) if math.isfinite(v) else None
        for v, s in zip(values, spread, strict=True)
    )
    assert top is not None and height is not None
    lower, upper, amplification, damping = rest
    return Resonance(
        omega=top, amplitude=height, lower=lower, upper=upper, amplification=amplification, damping=damping
    )


@dataclass(frozen=True, slots=True)
class _Rows:
    """The rows that say where a peak and its half-power speeds are, chosen once, and how they are weighted."""

    s: Reals  # (row,) 1 / omega^2, relative to that of the largest row
    scale: float  # rad/s
    weight: Reals  # (row,) of 1 / amplitude^2
    near: NDArray[np.intp]  # of the peak
    flanks: list[NDArray[np.intp]]  # below and above it; empty: no half power within the curve

    @classmethod
    def choose(cls, omega: Reals, amplitude: Reals, peak: int, sigma: Reals) -> "_Rows":
        s, top = (omega[peak] / omega) ** 2, amplitude[peak]
        weight = amplitude**3 / np.maximum(sigma, 1e-12 * top)  # 1 / sigma of 1 / amplitude^2, but for a factor
        ways = (np.arange(peak, -1, -1), np.arange(peak, len(omega)))  # down and up in speed
        widths = [_half_width(s, amplitude, way) for way in ways]
        width = min(widths) if min(widths) < math.inf else float(np.ptp(s))
        near = np.flatnonzero(np.abs(s - 1) <= NEAR_PEAK * width)
        flanks = [_flank(s, way, each) for way, each in zip(ways, widths, strict=True)]
        rows = cls(s, float(omega[peak]), weight / weight.max(), near, flanks)
        if len(near) < 3 or not s[near].min() <= rows._vertex(amplitude)[0] <= s[near].max():
            rows = replace(rows, near=np.arange(peak - 1, peak + 2))  # of which the middle one is the largest
        if np.sum(amplitude[max(peak - 2, 0) : peak + 3] > HALF_POWER * top) < FEWEST:
            return replace(rows, flanks=[way[:0] for way in ways])
        return replace(rows, flanks=[f if rows._crosses(amplitude, f) else f[:0] for f in flanks])

    def used(self) -> NDArray[np.intp]:
        """Return the rows of the curve that say something."""
        return np.unique(np.concatenate([self.near, *self.flanks]))

    def read(self, amplitude: Reals) -> Reals:
        """Return critical speed, amplitude, half-power speeds, amplification factor, damping ratio: (value, curve).

        `amplitude` (used row, curve) are variants of the curve.
        """
        s, y = self._top(amplitude)
        ends = [self._half_power(amplitude, y, flank) for flank in self.flanks]
        with np.errstate(invalid="ignore", divide="ignore"):  # NaN where a step of noise leaves no peak
            critical, lower, upper = self.scale / np.sqrt([s, *ends])
            amplification = critical / (upper - lower)
            return np.array([critical, y**-0.5, lower, upper, amplification, 0.5 / amplification])

    def _top(self, amplitude: Reals) -> tuple[Reals, Reals]:
        """Return s and 1 / amplitude^2 (curve,) at the vertex of a parabola through the rows near the peak."""
        values = amplitude[np.searchsorted(self.used(), self.near)] ** -2
        least = float(values.min())
        c, b, a = np.polyfit(self.s[self.near] - 1, values / least, 2, w=self.weight[self.near])
        with np.errstate(invalid="ignore", divide="ignore"):
            s, y = 1 - b / (2 * c), a - b * b / (4 * c)
        peaks = (c > 0) & (y > 0)
        return np.where(peaks, s, math.nan), np.where(peaks, y * least, math.nan)

    def _half_power(self, amplitude: Reals, y: Reals, flank: NDArray[np.intp]) -> Reals:
        """Return s (curve,) where 1 / amplitude^2 is twice `y`, that of the peak; NaN without a flank or a peak.

        x = sqrt(y(s) / y(peak) - 1) is a straight line over s for a single degree of freedom, and 1 at half power.
        """
        s, peaks = np.full(len(y), math.nan), np.isfinite(y)
        if not (flank.size and peaks.any()):
            return s
        here = amplitude[np.ix_(np.searchsorted(self.used(), flank), peaks)]
        x = np.sqrt(np.maximum(here**-2 / y[peaks] - 1, 0.0))
        weight = self.weight[flank] * np.maximum(x.mean(axis=1), 0.1)  # of x, whose change is that of y over 2 x
        slope, start = np.polyfit(self.s[flank] - 1, x, 1, w=weight)
        with np.errstate(invalid="ignore", divide="ignore"):
            s[peaks] = 1 + (1 - start) / slope
        return s

    def _vertex(self, amplitude: Reals) -> tuple[float, Reals]:
        """Return s of the peak of a whole curve (row,), and 1 / amplitude^2 there."""
        s, y = self._top(amplitude[self.used(), None])
        return float(s[0]), y

    def _crosses(self, amplitude: Reals, flank: NDArray[np.intp]) -> bool:
        """Return whether half power is reached within the curve, near the rows of a flank and on their side."""
        if not flank.size:
            return False
        s = float(self._half_power(amplitude[self.used(), None], self._vertex(amplitude)[1], flank)[0])
        side = self.s[flank[-1]] - 1
        return bool(0 < (s - 1) / side < FLANK[1] and self.s.min() <= s <= self.s.max())


def _half_width(s: Reals, amplitude: Reals, way: NDArray[np.intp]) -> float:
    """Return how far along `way`, in s from the peak, the first row below half power is; infinite if none."""
    fallen = amplitude[way] < HALF_POWER * amplitude[way[0]]
    return abs(float(s[way[np.argmax(fallen)]]) - 1) if fallen.any() else math.inf


def _flank(s: Reals, way: NDArray[np.intp], width: float) -> NDArray[np.intp]:
    """Return the rows about the half-power speed along `way`, at least one before the row at `width` and that."""
    if width == math.inf:
        return way[:0]
    away = np.abs(s[way] - 1) / width
    last = int(np.argmax(away >= 1))
    return way[min(last - 1, _first(away >= FLANK[0])) : max(last + 1, _first(away > FLANK[1]))]


def _first(which: NDArray[np.bool_]) -> int:
    """Return the first index that is true; their number if none is."""
    return int(np.argmax(which)) if which.any() else len(which)


def _root(covariance: Reals) -> Reals:
    """Return L with L L^T = covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))
