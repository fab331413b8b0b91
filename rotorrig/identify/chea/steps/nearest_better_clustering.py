"""Nearest-better clustering: which points of a sample are the best of their surroundings, and who belongs to whom.

After Preuss, "Niching the CMA-ES via nearest-better clustering" (GECCO 2010), in which every point is tied to the
nearest better one and long ties are cut. There a tie is long against the mean of all; here it is when none of the
nearest neighbours is better (Törn and Viitanen, "Topographical global optimization", 1994), which needs no threshold
and means the same in two dimensions and in ten.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]


def heads(points: Array, values: Array, *, neighbours: int) -> NDArray[np.intp]:
    """Return the rows, best first, of the points (n, dim) none of whose nearest `neighbours` has a lower value (n,).

    Points whose value is not finite head nothing, nor do those on a plateau.

    >>> heads(np.array([[0.0], [0.1], [0.2], [0.7], [0.8]]), np.array([1.0, 0.0, 2.0, 1.0, 3.0]), neighbours=1)
    array([1, 3])
    """
    k = min(neighbours, len(points) - 1)
    if k < 1:
        return np.empty(0, dtype=np.intp)
    rows = np.asarray(cKDTree(points).query(points, k=k + 1)[1])
    nearest = values[rows[:, 1:]]  # the first is the point itself
    heads_of_basins = np.flatnonzero((values <= nearest.min(axis=1)) & (values < nearest.max(axis=1)))
    return heads_of_basins[np.argsort(values[heads_of_basins], kind="stable")]
