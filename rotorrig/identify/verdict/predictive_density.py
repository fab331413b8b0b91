"""Density that a fitted model gives to data it never saw.

Their vectors scatter by the noise, by the model's own error, and by what the fit leaves open of its parameters: with
the rows of a resonance hidden, the curve of a probe is known up to the motion beside it and no further, so what it
makes of the largest motion says little about the model. An error counts by the standard deviation of all three
together (log predictive density: Gelman et al., Bayesian Data Analysis (3rd ed., 2013), ch. 7.2).
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from rotorrig.identify.adequacy import ADEQUACY
from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.verdict.settings import VERDICT

Complex = NDArray[np.complex128]


def block_deviances(problem: ExtendedProblem, vectors: Sequence[Mapping[int, Complex]], spread: Reals) -> Reals:
    """Return -2 log predictive density (block,) of a few neighbouring rows each.

    Less that of an exact prediction with nothing left open, so that it is 0 where no row is usable.

    `vectors` are the model's, order -> (row + 1, probe) [m] of every recording; `spread` is what its parameters leave
    open of the whitened figures of all recordings and orders, (figure + prior, direction), one standard deviation
    each.
    """
    blocks, first = [], 0
    for recording, model in zip(problem.recordings, vectors, strict=True):
        off, moved = [], []
        for order, measured in recording.measured.items():
            white = measured.sigmas(np.where(measured.usable, model[order] - measured.z, 0))
            off.append(white[:-1])
            moved.append(spread[first : first + white.size].reshape(*white.shape, spread.shape[1])[:-1])
            first += white.size
        rows, columns = np.concatenate(off, axis=1), np.concatenate(moved, axis=1)
        together = max(1, min(ADEQUACY.stretch, len(rows) // VERDICT.fewest_blocks))
        for start in range(0, len(rows), together):
            block = rows[start : start + together].ravel()
            blocks.append(deviance(block, columns[start : start + together].reshape(len(block), spread.shape[1])))
    return np.array(blocks)


def deviance(off: Reals, spread: Reals) -> float:
    """Return off^T C^-1 off + log det C with C = 1 + S S^T; `off` (figure,), the spread S (figure, direction).

    >>> round(deviance(np.array([3.0]), np.array([[2.0]])), 6)  # 9 / 5 + log 5
    3.409438
    """
    triangle = np.linalg.qr(np.vstack([spread, np.eye(spread.shape[1])]), mode="r")  # R^T R = 1 + S^T S
    known = solve_triangular(triangle, spread.T @ off, trans="T")
    return float(off @ off - known @ known + 2 * np.log(np.abs(np.diag(triangle))).sum())
