"""Keyphasor pulses to shaft angle: theta(t_k) = 2 pi turn_k at the chosen edge, a cubic spline through them between.

A once-per-turn pulse says nothing of the speed within a turn; the spline assumes it changes smoothly over a few turns
and is exact for a constant acceleration. A pulse at the wrong time is found by comparing its period with the median of
its neighbours'.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import median_filter, uniform_filter1d

from rotorrig.rig.errors import DataError

TURN = 2 * np.pi
NEIGHBOURS = 9  # periods in the running median; four flawed ones among them do no harm
SHORT, LONG = 0.7, 1.5  # of the neighbours' period; a run-up from rest shortens it by 0.71 after the second turn
WORST = 0.2  # share of flawed pulses beyond which the channel is no once-per-turn pulse
JITTER_POOL = 65  # edges
SEPARATION = 3.0  # levels apart, in scatter about them: 2.3 for pure noise, 3.8 for a sine, > 10 for a pulse


@dataclass(frozen=True, slots=True, kw_only=True)
class Flaw:
    """Turns whose angle is not to be trusted, and why."""

    first_turn: int
    last_turn: int
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftAngle:
    """Shaft angle as a function of time on the recording's clock."""

    t: NDArray[np.float64]  # (pulse,) s, accepted edges
    turn: NDArray[np.int64]  # (pulse,) turns since the first edge; jumps by more than one where pulses are missing
    flaws: tuple[Flaw, ...]
    spline: CubicSpline  # rad over s

    def theta(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the shaft angle [rad] at times t [s], 0 at the first edge."""
        return self.spline(t)

    def omega(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the speed [rad/s] at times t [s]."""
        return self.spline(t, 1)

    def time_at(self, turn: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the time [s] at which the shaft has made `turn` turns, fractions included, by Newton's method."""
        k = np.clip(np.searchsorted(self.turn, turn, side="right") - 1, 0, len(self.t) - 2)
        t = np.interp(turn, self.turn, self.t)
        for _ in range(4):
            slope = np.maximum(self.omega(t), 1e-6)  # a spline may dip where the rotor stands still
            t = np.clip(t - (self.theta(t) - TURN * turn) / slope, self.t[k], self.t[k + 1])
        return t

    def pulses(self) -> NDArray[np.float64]:
        """Return an edge time [s] for every turn: the accepted ones, interpolated where pulses are missing."""
        every = np.arange(self.turn[-1] + 1)
        t = self.time_at(every.astype(float))
        t[self.turn] = self.t
        return t

    def jitter(self, turn: NDArray[np.float64], *, first: int, last: int) -> NDArray[np.float64]:
        """Return the 1-sigma timing error [s] of single edges around each of `turn`, from turns `first` to `last`.

        From fourth differences of the edge times, which a smooth speed leaves at zero and white errors of variance s^2
        bring to 70 s^2 (1 + 16 + 36 + 16 + 1); root mean square over 65 edges, so known to about 15 %. Flawed turns
        are left out, and what lies beyond the range: a start from rest is no smooth speed.
        """
        regular = (self.turn[4:] - self.turn[:-4] == 4) & (self.turn[:-4] >= first) & (self.turn[4:] <= last)
        centre = self.turn[2:-2][regular].astype(float)
        if len(centre) == 0:
            return np.zeros(len(turn))
        variance = np.diff(self.t, 4)[regular] ** 2 / 70
        pooled = uniform_filter1d(variance, min(JITTER_POOL, len(centre)), mode="reflect")
        return np.sqrt(np.interp(turn, centre, pooled))


def shaft_angle(
    edges: NDArray[np.float64], *, gaps: Sequence[tuple[float, float]] = (), where: str = "keyphasor"
) -> ShaftAngle:
    """Return the shaft angle through keyphasor edges at times `edges` [s], increasing.

    `gaps` are stretches [s] without samples. Extra pulses are dropped, missed ones counted; both leave a `Flaw` over
    the turns they touch. Raises DataError for fewer than 5 edges or too many flawed ones.
    """
    if len(edges) < 5:
        raise DataError(f"{where}: got {len(edges)} keyphasor pulses, want at least 5")
    t, extra = _without_extra(edges, where)
    ratio = np.diff(t) / _typical(np.diff(t))
    step = np.where(ratio > LONG, np.maximum(np.round(ratio), 1), 1).astype(np.int64)
    turn = np.concatenate([[0], np.cumsum(step)])
    in_gap = np.zeros(len(step), dtype=bool)
    for begin, end in gaps:
        in_gap |= (t[:-1] < end) & (t[1:] > begin)
    missed = (step > 1) & ~in_gap
    if len(extra) + missed.sum() > WORST * len(edges):
        raise DataError(
            f"{where}: {len(extra)} extra and {missed.sum()} missed among {len(edges)} keyphasor pulses, "
            "want one clean pulse per turn; check keyphasor.threshold and keyphasor.edge"
        )
    flaws = [Flaw(first_turn=a, last_turn=b, reason="gap in the samples") for a, b in _turns(turn, in_gap)]
    flaws += [Flaw(first_turn=a, last_turn=b, reason="missed pulse") for a, b in _turns(turn, missed)]
    for time in extra:
        k = int(np.interp(time, t, turn))
        flaws.append(Flaw(first_turn=k, last_turn=k + 1, reason="extra pulse"))
    return ShaftAngle(t=t, turn=turn, flaws=tuple(flaws), spline=CubicSpline(t, TURN * turn.astype(float)))


def find_edges(
    volts: NDArray[np.float64], *, edge: str, threshold: float, band: float, first_sample: int = 0
) -> NDArray[np.float64]:
    """Return where `volts` (sample,) crosses `threshold` on the "falling" or "rising" edge, in fractional samples.

    A crossing counts when the voltage has left the band of `band` volts about the threshold on one side and then on
    the other; its place is interpolated linearly between the two samples about the threshold.

    >>> find_edges(np.array([0.0, 0, -4, -8, -8, 0, 0]), edge="falling", threshold=-5.0, band=2.0)
    array([2.25])
    """
    v = volts - threshold if edge == "rising" else threshold - volts
    outside = np.flatnonzero(np.abs(v) > band / 2)
    above = v[outside] > 0
    crossed = outside[1:][above[1:] & ~above[:-1]]  # first sample beyond the band on the far side
    crossings = np.flatnonzero((v[:-1] < 0) & (v[1:] >= 0)) + 1
    after = crossings[np.searchsorted(crossings, crossed, side="right") - 1]
    return first_sample + after - v[after] / (v[after] - v[after - 1])


def levels(volts: NDArray[np.float64], *, where: str = "keyphasor") -> tuple[float, float]:
    """Return the low and high level [V] of a pulse train, flanks and spikes ignored.

    The fullest bin of the histogram's either half, then the median of the samples near it (IEEE Std 181, histogram
    modes). Raises DataError if the samples hold no two levels.
    """
    bottom, top = float(volts.min()), float(volts.max())
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


def _without_extra(edges: NDArray[np.float64], where: str) -> tuple[NDArray[np.float64], list[float]]:
    """Drop, one by one, edges that cut a period short; of the two about a short period the one that does not fit."""
    t = edges
    dropped: list[float] = []
    while len(t) >= 5:
        period = np.diff(t)
        typical = _typical(period)
        short = np.flatnonzero(period < SHORT * typical)
        if len(short) == 0:
            return t, dropped
        if len(dropped) > WORST * len(edges):
            break
        i = int(short[0])
        # dropping edge i or i + 1 leaves one longer period: keep the choice that comes nearest to the neighbours'
        first = abs(period[i - 1] + period[i] - typical[i]) if i > 0 else np.inf
        second = abs(period[i] + period[i + 1] - typical[i]) if i + 1 < len(period) else np.inf
        k = i if first < second else i + 1
        dropped.append(float(t[k]))
        t = np.delete(t, k)
    raise DataError(
        f"{where}: more than {WORST:.0%} of {len(edges)} keyphasor pulses come too early, want one clean pulse "
        "per turn; check keyphasor.threshold and keyphasor.edge"
    )


def _typical(period: NDArray[np.float64]) -> NDArray[np.float64]:
    return median_filter(period, NEIGHBOURS, mode="nearest")


def _turns(turn: NDArray[np.int64], flawed: NDArray[np.bool_]) -> list[tuple[int, int]]:
    return [(int(turn[i]), int(turn[i + 1])) for i in np.flatnonzero(flawed)]
