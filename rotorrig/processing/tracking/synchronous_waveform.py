"""Synchronous waveforms: samples at equal steps of shaft angle, turns that can be laid over each other.

Every sample takes part: the waveform is low-passed to what the new points can hold, half as many orders as there are
points per turn, and read at the points' own times, in one sum with a Kaiser-windowed sinc in time (Smith and Gossett,
Proc. ICASSP 1984, 19.4). Up to two thirds of that order, and of half the sample rate where that is less, amplitudes are
right to 1e-5; what lies above four thirds of it is 1e-5 or less of what it was.
"""

from functools import cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.waveform import Stretch, Waveforms

CROSSINGS = 12  # zero crossings of the sinc on either side
BETA = 10.0  # of its Kaiser window: -100 dB
_FINE = 2048  # entries of the filter's table per zero crossing; straight lines between them are right to 3e-7


def resample(
    stretch: Stretch, shaft: ShaftAngle, *, first_turn: float, turns: float, points: int
) -> NDArray[np.float64]:
    """Return the waveforms [m] at `points` equal steps of shaft angle per turn, (turns * points, probe).

    The first point is at turn `first_turn` (whole numbers are keyphasor edges, as in `ShaftAngle.turn`), the last one
    step before turn `first_turn + turns`. At the ends of the stretch the waveform is continued by reflection about its
    last sample, so let it begin and end `margin` seconds beyond the turns where that is to be had.
    """
    at = first_turn + np.arange(round(turns * points)) / points
    t = shaft.time_at(at)
    rate = (len(stretch.t) - 1) / (stretch.t[-1] - stretch.t[0])
    per_point = shaft.omega(t) / TURN * points / rate  # points per sample
    return _interpolate(stretch.x, (t - stretch.t[0]) * rate, np.minimum(per_point, 1.0), _table())


def margin(omega: float, *, points: int, rate: float) -> float:
    """Return the reach [s] of the filter to either side at speed omega [rad/s] and a sample rate [Hz]."""
    return CROSSINGS / min(rate, points * omega / TURN)


@cache
def _table() -> NDArray[np.float64]:
    """Return the right half of the filter, its argument in zero crossings, `_FINE` entries to each."""
    x = np.arange(CROSSINGS * _FINE + 1) / _FINE
    return np.sinc(x) * np.kaiser(2 * len(x) - 1, BETA)[len(x) - 1 :]


@njit(cache=True)
def _interpolate(
    x: NDArray[np.float64], at: NDArray[np.float64], cutoff: NDArray[np.float64], table: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return `x` (sample, probe) at places `at` (point,) in samples, low-passed at `cutoff` of half the sample rate."""
    samples, probes = x.shape
    points = np.zeros((len(at), probes))
    for k in range(len(at)):
        reach = CROSSINGS / cutoff[k]
        total = 0.0
        for i in range(int(np.ceil(at[k] - reach)), int(np.floor(at[k] + reach)) + 1):
            place = abs(i - at[k]) * cutoff[k] * _FINE
            entry = min(int(place), len(table) - 2)
            weight = table[entry] + (place - entry) * (table[entry + 1] - table[entry])
            total += weight
            inside = min(max(i, 0), samples - 1)
            reflected = min(max(2 * inside - i, 0), samples - 1)
            for p in range(probes):
                value = x[inside, p]
                points[k, p] += weight * (value if reflected == inside else 2 * value - x[reflected, p])
        for p in range(probes):
            points[k, p] /= total
    return points


def row_waveform(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, row: int, *, points: int
) -> NDArray[np.float64] | None:
    """Return the displacement [m] over a row's turns, (turns * points, probe); None where samples are missing.

    The first point is `first_point` of the row, so all points lie at whole steps of a turn / `points` from a keyphasor
    edge, wherever the row begins. The samples on either side of the row take part where there are any, so that its
    first and last points are as good as the others.
    """
    first = first_point(rows, row, points=points) / points
    begin, end = shaft.time_at(np.array([first, first + rows.turns]))
    reach = margin(float(rows.omega[row]), points=points, rate=waveforms.rate)
    stretch = waveforms.between(begin - reach, end + reach) or waveforms.between(begin, end)
    if stretch is None or len(stretch.t) < 2:
        return None
    return resample(stretch, shaft, first_turn=first, turns=rows.turns, points=points)


def first_point(rows: Rows, row: int, *, points: int) -> int:
    """Return the number of the first point within a row, in steps of a turn / `points` from turn 0."""
    return int(np.ceil(float(rows.first_turn[row]) * points - 1e-6))
