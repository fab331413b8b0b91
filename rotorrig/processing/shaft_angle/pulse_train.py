"""Count keyphasor pulses: drop extra edges, and number the missing ones between two pulses.

A pulse at the wrong time is found by comparing its period with the median of its neighbours'.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from rotorrig.rig import DataError

NEIGHBOURS = 9  # periods in the running median; four flawed ones among them do no harm
BESIDE = 3  # periods on either side that tell the speed across a long one
SHORT, LONG = 0.7, 1.5  # of the neighbours' period; a run-up from rest shortens it by 0.71 after the second turn
WORST = 0.2  # share of flawed pulses beyond which the channel holds no pulse per turn
MOST_MISSED = 5  # in a row; more may be a rotor that stood still
COUNTED = 0.25  # of a period: how far a step may be from a whole number of periods for its pulses to be counted
FEWEST = 5  # pulses; so there are four periods
WANTED = "want clean pulses, keyphasor.pulses_per_revolution of them; check that, keyphasor.threshold and .edge"
Gaps = Sequence[tuple[float, float]]  # stretches [s] without samples


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTrain:
    """Pulses and their numbers."""

    t: NDArray[np.float64]  # (pulse,) s
    number: NDArray[np.int64]  # (pulse,) from 0; jumps by more than one where pulses are missing
    extra: tuple[float, ...]  # s, edges that were no pulses
    missed: NDArray[np.bool_]  # (pulse - 1,) pulses are missing in this step
    uncounted: NDArray[np.bool_]  # (pulse - 1,) nobody can tell how many
    in_gap: NDArray[np.bool_]  # (pulse - 1,) samples are missing in this step


def count_pulses(edges: NDArray[np.float64], *, gaps: Gaps = (), where: str = "keyphasor") -> PulseTrain:
    """Return the pulses among edges at times `edges` [s], increasing, evenly spaced in angle.

    Raises DataError for fewer than 5 edges or too many that are extra or missed.
    """
    if len(edges) < FEWEST:
        raise DataError(f"{where}: got {len(edges)} keyphasor pulses, want at least {FEWEST}")
    t, extra = _without_extra(edges, where)
    period = np.diff(t)
    typical = _typical(period)
    typical[0], typical[-1] = (
        _end_period(period[1], period[2], typical[0]),
        _end_period(period[-2], period[-3], typical[-1]),
    )
    ratio = period / typical
    for i in np.flatnonzero(ratio > LONG):
        ratio[i] = period[i] * _speed_across(period, int(i))
    step = np.where(ratio > LONG, np.maximum(np.round(ratio), 1), 1).astype(np.int64)
    in_gap = steps_across(gaps, t)
    missed = (step > 1) & ~in_gap
    if len(extra) + missed.sum() > WORST * len(edges):
        raise DataError(
            f"{where}: {len(extra)} extra and {missed.sum()} missed among {len(edges)} keyphasor pulses, {WANTED}"
        )
    return PulseTrain(
        t=t,
        number=np.concatenate([[0], np.cumsum(step)]),
        extra=tuple(extra),
        missed=missed,
        uncounted=missed & ((np.abs(ratio - step) > COUNTED) | (step > MOST_MISSED + 1)),
        in_gap=in_gap,
    )


def steps_across(gaps: Gaps, t: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the mask (pulse - 1,) of steps between the pulses `t` with missing samples."""
    in_gap = np.zeros(len(t) - 1, dtype=bool)
    for begin, end in gaps:
        in_gap |= (t[:-1] < end) & (t[1:] > begin)
    return in_gap


def _without_extra(edges: NDArray[np.float64], where: str) -> tuple[NDArray[np.float64], list[float]]:
    """Drop edges that cut a period short; of the two about a short period the one that does not fit."""
    t = edges
    dropped: list[float] = []
    while len(t) >= FEWEST:
        period = np.diff(t)
        typical = _typical(period)
        short = np.flatnonzero(period < SHORT * typical)
        if len(short) == 0:
            return t, sorted(dropped)
        if len(dropped) > WORST * len(edges):
            break
        alone = short[np.append(True, np.diff(short) > NEIGHBOURS)]  # the first of each bunch
        worst = np.unique([_misfit(period, typical, int(i)) for i in alone])
        dropped += t[worst].tolist()
        t = np.delete(t, worst)
    raise DataError(f"{where}: more than {WORST:.0%} of {len(edges)} keyphasor pulses come too early, {WANTED}")


def _misfit(period: NDArray[np.float64], typical: NDArray[np.float64], i: int) -> int:
    """Return the edge about the short period i to drop: the one without which the period is like its neighbours'.

    At either end the neighbours lie on one side, and the period goes on as they do.
    """
    if i == 0:
        without_first, without_second, want = period[1], period[0] + period[1], 2 * period[2] - period[3]
    elif i + 1 == len(period):
        without_first, without_second, want = period[i - 1] + period[i], period[i - 1], 2 * period[-3] - period[-4]
    else:
        without_first, without_second, want = period[i - 1] + period[i], period[i] + period[i + 1], typical[i]
    return i if abs(without_first - want) < abs(without_second - want) else i + 1


def _speed_across(period: NDArray[np.float64], i: int) -> float:
    """Return the mean speed [pulse/s] across the long period i: halfway between those before and after it."""
    sides = (period[max(i - BESIDE, 0) : i], period[i + 1 : i + 1 + BESIDE])
    return float(np.mean([1 / np.median(side) for side in sides if len(side)]))


def _typical(period: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what each period (step,) would be by its neighbours: their median."""
    return median_filter(period, NEIGHBOURS, mode="mirror")


def _end_period(next_one: float, next_but_one: float, usual: float) -> float:
    """Return the period at an end by the next two, at constant acceleration as of a start from rest; or the `usual`."""
    if next_one <= next_but_one:
        return usual
    rate = 2 * (1 / next_but_one - 1 / next_one) / (next_one + next_but_one)  # turns/s^2
    speed = 1 / next_one - rate * next_one / 2  # turns/s, between the period and the next
    return max(usual, (speed - np.sqrt(max(speed**2 - 2 * rate, 0.0))) / rate)
