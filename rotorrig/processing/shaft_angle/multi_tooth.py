"""Keyphasor wheels with several teeth: the tooth of every pulse, and the angles of the teeth on the shaft.

The pattern of the intervals repeats every turn. A stretch in which it does so best tells it, and from there the pulses
are followed either way: one that comes nowhere near a tooth is extra, a tooth without a pulse is missed.

Tooth 0, where the angle is zero, follows the widest interval, if that is wider than all others by a tenth of an even
one: a wheel with a tooth missing, or displaced. Else it is the first pulse of the recording; it cannot be found again
in another one, nor after a gap in the samples, where the pulses are then not used.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from rotorrig.processing.shaft_angle.pulse_train import (
    FEWEST,
    MOST_MISSED,
    WANTED,
    WORST,
    Gaps,
    PulseTrain,
    steps_across,
)
from rotorrig.processing.shaft_angle.smooth_angle import TURN, fit_angle
from rotorrig.rig import DataError

MARK = 0.1  # of an even interval: how much wider the widest is to be
REPEATS = 0.25  # of an even interval: how far the best turns may be from a pattern that repeats
NEAR = 0.3  # of the narrower interval beside it: how far from a tooth its pulse may come
RECENT = 5  # intervals that tell the time of a turn
EXTRA = np.iinfo(np.int64).min  # in place of a number


@dataclass(frozen=True, slots=True, kw_only=True)
class Wheel:
    """The pulses of a wheel with several teeth, counted; number 0 is the first pulse of tooth 0."""

    train: PulseTrain
    teeth: int
    marked: bool  # tooth 0 can be told from the others


def count_teeth(edges: NDArray[np.float64], *, teeth: int, gaps: Gaps = (), where: str = "keyphasor") -> Wheel:
    """Return the pulses among edges at times `edges` [s], increasing, of a wheel with `teeth` teeth.

    Raises DataError for fewer than five turns without a gap, or if no pattern repeats every turn.
    """
    stretches = np.split(edges, np.flatnonzero(steps_across(gaps, edges)) + 1)
    stretches = [stretch for stretch in stretches if len(stretch) >= FEWEST * teeth]
    if not stretches:
        raise DataError(f"{where}: got {len(edges)} keyphasor pulses, want {FEWEST} turns of {teeth} without a gap")
    counted = [_Counted.of(stretch, teeth, where) for stretch in stretches]
    marked = counted[0].first is not None
    counted = [part for part in counted if part.first is not None] if marked else counted[:1]
    t, number = counted[0].t, counted[0].from_tooth_0()
    for part in counted[1:]:
        t, number = _append_stretch(t, number, part)
    number -= teeth * (-(-number[0] // teeth))
    step = np.diff(number)
    in_gap = steps_across(gaps, t)
    missed = (step > 1) & ~in_gap
    extra = [time for part in counted for time in part.extra]
    if len(extra) + missed.sum() > WORST * len(edges):
        raise DataError(
            f"{where}: {len(extra)} extra and {missed.sum()} missed among {len(edges)} keyphasor pulses, {WANTED}"
        )
    train = PulseTrain(
        t=t,
        number=number,
        extra=tuple(extra),
        missed=missed,
        uncounted=missed & (step > MOST_MISSED + 1),
        in_gap=in_gap,
    )
    return Wheel(train=train, teeth=teeth, marked=marked)


def tooth_angles(wheel: Wheel, *, where: str = "keyphasor") -> NDArray[np.float64]:
    """Return the angle (tooth,) [rad] of each tooth from tooth 0, in (0, 2 pi) but for the first.

    The median over the turns of where each tooth is by the smooth angle through tooth 0 alone: a wheel that runs out is
    so told from a speed that swings, which does not keep step with the shaft. Raises DataError for fewer than five
    pulses of tooth 0.
    """
    train, teeth = wheel.train, wheel.teeth
    turn, tooth = np.divmod(train.number, teeth)
    zero = np.flatnonzero(tooth == 0)
    if len(zero) < FEWEST:
        raise DataError(f"{where}: got {len(zero)} keyphasor pulses of the same tooth, want at least {FEWEST}")
    broken = np.add.reduceat(train.in_gap | train.uncounted, zero[:-1]) > 0
    cut = broken | (np.diff(turn[zero]) > MOST_MISSED + 1)
    angle = fit_angle(train.t[zero], TURN * turn[zero], cut=cut).curve
    between = np.searchsorted(zero, np.arange(len(tooth)), side="right") - 1
    known = (between >= 0) & (between < len(cut))
    known[known] = ~cut[between[known]]
    places = TURN * np.arange(teeth) / teeth
    for j in range(1, teeth):
        mine = known & (tooth == j)
        if mine.any():
            places[j] = np.median(angle(train.t[mine]) - TURN * turn[mine])
    return places


@dataclass(frozen=True, slots=True, kw_only=True)
class _Counted:
    """The pulses of a stretch without gaps."""

    t: NDArray[np.float64]  # (pulse,) s
    number: NDArray[np.int64]  # (pulse,) from any
    teeth: int
    first: int | None  # a number of tooth 0; None: the wheel is not marked
    extra: tuple[float, ...]  # s

    @classmethod
    def of(cls, t: NDArray[np.float64], teeth: int, where: str) -> "_Counted":
        """Count the pulses at `t` from where their pattern repeats best."""
        at, interval = _pattern(t, teeth, where)
        forwards = _follow(t[at:], interval)
        backwards = _follow(-t[at::-1], interval[::-1].copy())
        number = np.concatenate([-np.where(backwards == EXTRA, -EXTRA, backwards)[:0:-1], forwards])
        pulse = number != EXTRA
        widest = int(np.argmax(interval))
        wider = interval[widest] - np.max(np.delete(interval, widest))
        return cls(
            t=t[pulse],
            number=number[pulse],
            teeth=teeth,
            first=widest + 1 if wider > MARK / teeth else None,
            extra=tuple(t[~pulse].tolist()),
        )

    def from_tooth_0(self) -> NDArray[np.int64]:
        """Return the numbers (pulse,), multiples of the number of teeth at tooth 0."""
        return self.number - (self.number[0] if self.first is None else self.first)


def _pattern(t: NDArray[np.float64], teeth: int, where: str) -> tuple[int, NDArray[np.float64]]:
    """Return the index of a pulse, and the intervals (tooth,) [turn] from it on: where two turns are most alike."""
    share = np.diff(t)[: len(t) - teeth] / (t[teeth:] - t[:-teeth])
    change = np.abs(share[teeth:] - share[:-teeth])
    unlike = sliding_window_view(change, teeth).max(axis=1)
    at = int(np.argmin(unlike))
    if unlike[at] > REPEATS / teeth:
        raise DataError(f"{where}: no pattern of {teeth} pulses repeats every turn, {WANTED}")
    interval = share[at : at + teeth] + share[at + teeth : at + 2 * teeth]
    return at, interval / interval.sum()


@njit(cache=True)
def _follow(t: NDArray[np.float64], interval: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the number of each pulse from the first, 0, or EXTRA; `interval` (tooth,) [turn] is what follows each.

    The first turn has all its pulses. Of two near the same tooth the nearer one counts; after a whole turn of extra
    pulses the next one does in any case. The speed is the median over the last few intervals.
    """
    teeth = len(interval)
    number = np.full(len(t), EXTRA)
    number[0] = 0
    last, origin, due = 0, 0.0, t[0]  # the last pulse; the one before it and when the last was due by that [s]
    strays, accepted = 0, 0
    recent = np.full(RECENT, t[teeth] - t[0])  # s, turn times
    for i in range(1, len(t)):
        turn_time = _median(recent)
        turned = (t[i] - t[last]) / turn_time
        ahead, place = 0, 0.0
        step, before = interval[number[last] % teeth], interval[(number[last] - 1) % teeth]
        while turned > place + step / 2:
            place += step
            ahead += 1
            before, step = step, interval[(number[last] + ahead) % teeth]
        if ahead == 0 and abs(t[i] - due) < abs(t[last] - due):
            number[i], number[last] = number[last], EXTRA
            recent[accepted % RECENT] *= (t[i] - origin) / (t[last] - origin) if accepted else 1.0
            last = i
        elif ahead > 0 and (abs(turned - place) <= NEAR * min(before, step) or strays >= teeth):
            number[i] = number[last] + ahead
            accepted += 1
            recent[accepted % RECENT] = (t[i] - t[last]) / place
            origin, due = t[last], t[last] + place * turn_time
            last, strays = i, 0
        else:
            strays += 1
    return number


@njit(cache=True)
def _median(values: NDArray[np.float64]) -> float:
    """Return the median of an odd number of values, by ranks: compiled ten times as fast as numpy's."""
    for value in values:
        if np.sum(values < value) <= len(values) // 2 < np.sum(values <= value):
            return value
    return values[0]


def _append_stretch(
    t: NDArray[np.float64], number: NDArray[np.int64], part: _Counted
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return times and numbers with a further stretch's behind them, as many turns on as the speed before makes."""
    teeth = part.teeth
    turn_time = (t[-1] - t[-1 - teeth]) / (number[-1] - number[-1 - teeth]) * teeth
    following = part.from_tooth_0()
    turns = round((part.t[0] - t[-1]) / turn_time + (number[-1] - following[0]) / teeth)
    following = following + teeth * turns
    if following[0] <= number[-1]:
        following += teeth * (1 + (number[-1] - following[0]) // teeth)
    return np.append(t, part.t), np.append(number, following)
