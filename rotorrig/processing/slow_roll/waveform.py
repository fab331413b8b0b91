"""Slow-roll waveform: one turn of run-out and bow as a probe reads them, and compensation by shaft angle.

An average over the turns of the slow roll, each row under its window in angle, so that the waveform's n-th
harmonic is the slow-roll vector of order n as resampling tracks it (other methods agree within their noise), for every
n at once and not only for the orders that were asked for. The mean is taken out: a compensated waveform keeps its gap.
Raw waveforms are never changed; compensation is a pair of functions that undo each other.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.slow_roll.vector import SlowRoll
from rotorrig.processing.tracking import first_point, row_waveform
from rotorrig.processing.waveform import Waveforms
from rotorrig.processing.windows import blackman
from rotorrig.rig import DataError

MOST_POINTS = 512  # per turn: run-out up to order 180
FEWEST_POINTS = 16


def slow_roll_waveform(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, slow: SlowRoll, *, chosen: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the mean waveform (probe, point) [m] of the slow roll at equal steps of angle from the keyphasor edge on.

    `chosen` (row,) are the rows `slow` was estimated from. A probe without a slow-roll vector has NaN; (0, 0) where
    there is no slow roll at all.
    """
    used = np.flatnonzero(chosen)[slow.used]
    if not len(used):
        return np.empty((0, 0))
    points = points_per_turn(waveforms.rate * TURN / float(rows.omega[used].max()))
    total, count = np.zeros((points, waveforms.probes)), 0
    for row in used:
        x = row_waveform(waveforms, shaft, rows, int(row), points=points)
        if x is not None:
            first = first_point(rows, int(row), points=points)
            behind = first / points - float(rows.first_turn[row])
            total += np.roll(turn_average(x, turns=rows.turns, behind=behind), first % points, axis=0)
            count += 1
    if not count:
        return np.empty((0, 0))
    mean = total / count
    mean[:, ~np.isfinite(slow.z).all(axis=1)] = np.nan
    return (mean - mean.mean(axis=0)).T


def turn_average(x: NDArray[np.float64], *, turns: int, behind: float = 0.0) -> NDArray[np.float64]:
    """Return one turn (point, probe) of `x` (turns * point, probe), averaged under Blackman's window over all of them.

    The window begins `behind` turns before the first point, less than one step. 2 mean(turn e^{-j n theta}) is then
    the order vector n of the same window, see resampling.
    """
    psi = TURN * turns * (np.arange(len(x)) / len(x) - 0.5) + TURN * behind
    weight = blackman(psi, turns=turns).reshape(turns, -1, 1)
    return np.asarray((weight * x.reshape(turns, -1, x.shape[1])).sum(axis=0) / weight.sum(axis=0))


def points_per_turn(samples_per_turn: float) -> int:
    """Return a number of points per turn, a power of two, that these samples can fill."""
    return int(np.clip(2 ** np.floor(np.log2(samples_per_turn)), FEWEST_POINTS, MOST_POINTS))


def subtract(x: NDArray[np.float64], theta: NDArray[np.float64], waveform: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return x (sample, probe) [m] at shaft angles theta (sample,) [rad] less the slow-roll waveform (probe, point).

    Raises DataError where the waveform is missing.
    """
    return x - at_angles(waveform, theta)


def restore(
    compensated: NDArray[np.float64], theta: NDArray[np.float64], waveform: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Undo `subtract`."""
    return compensated + at_angles(waveform, theta)


def at_angles(waveform: NDArray[np.float64], theta: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slow-roll waveform (probe, point) at shaft angles theta (sample,) [rad], (sample, probe).

    A periodic cubic spline through its points: order n is right to (2 pi n / points)^4 / 384 of its amplitude.
    """
    if not waveform.size or not np.isfinite(waveform).all():
        raise DataError("the response has no slow-roll waveform to compensate with, want a recording with a slow roll")
    points = waveform.shape[1]
    closed = np.concatenate([waveform, waveform[:, :1]], axis=1).T
    spline = CubicSpline(np.arange(points + 1) / points, closed, bc_type="periodic")
    return np.asarray(spline(np.mod(theta / TURN, 1.0)))
