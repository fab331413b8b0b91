"""Scatter of a residual from row to row: what the noise is, where the rows of a misfit would follow each other.

Half the mean square of the difference of neighbours is the variance of what is independent from row to row, and next to
nothing of what is smooth (von Neumann, Annals of Mathematical Statistics 12 (1941) 367). Third differences leave even
less of it, where a model may be wrong by many sigmas.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

Reals = NDArray[np.float64]

FEWEST = 8  # rows of a run that tell
THIRD = 20.0  # 1 + 9 + 9 + 1: the variance of a third difference of independent values
MEDIAN = float(chdtri(1.0, 0.5))  # of chi2 with one degree of freedom


def row_variance(white: Reals, run: NDArray[np.intp]) -> float:
    """Return half the mean square of the differences of neighbouring rows within a run; NaN if there are none.

    `white` (row, value) is a residual in sigmas, NaN where nothing was measured.
    """
    halves = np.concatenate([(np.diff(white[run == number], axis=0) ** 2 / 2).ravel() for number in np.unique(run)])
    known = halves[np.isfinite(halves)]
    return float(known.mean()) if len(known) else float("nan")


def local_excess(white: NDArray[np.complex128], rows: NDArray[np.intp], *, around: int, apart: int = 1) -> float:
    """Return by how much the variance of consecutive `rows` is more than one, by them and `around` on either side.

    `white` (row,) is the residual of one run in standard deviations, complex, of mean square one; NaN where nothing was
    measured. Never less than 1. By differences of rows so many `apart`.
    """
    near = white[max(rows[0] - around, 0) : rows[-1] + 1 + around]
    halves = np.abs(near[apart:] - near[:-apart]) ** 2 / 2
    known = halves[np.isfinite(halves)]
    return max(1.0, float(known.mean())) if len(known) >= FEWEST else 1.0


def excess_scatter(white: Reals, run: NDArray[np.intp]) -> Reals:
    """Return by how much the variance of a row's values is more than stated, (row,), the same in a whole run.

    It is never less than 1: who states a larger one knows of errors that all rows share. By the median of squared third
    differences, which the few rows of a narrow misfit do not move.
    """
    factor = np.ones(len(white))
    for number in np.unique(run):
        rows = np.flatnonzero(run == number)
        third = np.diff(white[rows], n=3, axis=0) ** 2 / THIRD
        if np.isfinite(third).any(axis=1).sum() >= FEWEST:
            factor[rows] = max(1.0, float(np.nanmedian(third)) / MEDIAN)
    return factor
