"""The waveforms of one row at equal steps of shaft angle."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.equal_angles import margin, resampled
from rotorrig.processing.rows.rows import Rows
from rotorrig.processing.shaft_angle.shaft_angle import ShaftAngle
from rotorrig.processing.waveform import Waveforms


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
    return resampled(stretch, shaft, first_turn=first, turns=rows.turns, points=points)


def first_point(rows: Rows, row: int, *, points: int) -> int:
    """Return how many steps of a turn / `points` after turn 0 the first point within a row is."""
    return int(np.ceil(float(rows.first_turn[row]) * points - 1e-6))
