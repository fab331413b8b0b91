"""Samples row by row, with the shaft angle and speed at each."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.waveform import Waveforms

Reals = NDArray[np.float64]


class RowSamples(NamedTuple):
    """Samples within a row."""

    x: Reals  # (sample, probe) m
    psi: Reals  # (sample,) rad from the row's middle angle
    omega: Reals  # (sample,) rad/s


def samples_by_row(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, progress: Callable[[float], None] | None = None
) -> Iterator[tuple[int, RowSamples]]:
    """Yield the rows whose samples are all there, with their number. `progress` gets the fraction done."""
    for i, (begin, end) in enumerate(zip(rows.begin, rows.end, strict=True)):
        stretch = waveforms.between(begin, end)
        if stretch is not None and len(stretch.t):
            angle, omega = angle_and_speed(stretch.t, shaft.spline.x, shaft.spline.c)
            yield i, RowSamples(x=stretch.x, psi=angle - TURN * rows.middle[i], omega=omega)
        if progress:
            progress((i + 1) / len(rows.t))


@njit(cache=True)
def angle_and_speed(t: Reals, breaks: Reals, coefficients: Reals) -> tuple[Reals, Reals]:
    """Return angle [rad] and speed [rad/s] at increasing times t, of a piecewise polynomial as scipy's PPoly has it."""
    angle, speed = np.empty(len(t)), np.empty(len(t))
    last = len(breaks) - 2
    piece = min(max(np.searchsorted(breaks, t[0], side="right") - 1, 0), last) if len(t) else 0
    for i in range(len(t)):
        while piece < last and t[i] >= breaks[piece + 1]:
            piece += 1
        since = t[i] - breaks[piece]
        theta = omega = 0.0
        for k in range(len(coefficients)):  # Horner, with the derivative beside it
            omega = omega * since + theta
            theta = theta * since + coefficients[k, piece]
        angle[i], speed[i] = theta, omega
    return angle, speed
