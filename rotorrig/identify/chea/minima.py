"""`Minima`: the local minima found, each once."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def one_point(points: Sequence[Array], tolerance: float) -> bool:
    """Return whether all points (dim,) lie within `tolerance` of the first, "nearly the same point" of section 2.

    >>> one_point([np.zeros(2), np.array([0.0, 0.005])], 0.01)
    True
    """
    return all(_distance(point, points[0]) <= tolerance for point in points)


class Minima:
    """Ends of local searches; those within `tolerance` of one another are one minimum, kept at its lowest."""

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._u: list[Array] = []
        self._fun: list[float] = []

    @property
    def best(self) -> float:
        """The lowest value found, +inf before the first."""
        return min(self._fun, default=np.inf)

    def add(self, u: Array, fun: float) -> None:
        """Take in the end of a local search at `u` (dim,) of the unit cube."""
        for i, known in enumerate(self._u):
            if _distance(u, known) <= self._tolerance:
                if fun < self._fun[i]:
                    self._u[i], self._fun[i] = u, fun
                return
        self._u.append(u)
        self._fun.append(fun)

    def sorted(self, dim: int) -> tuple[Array, Array]:
        """Return the points (n, dim) in the unit cube and their values (n,), best first."""
        order = np.argsort(self._fun, kind="stable")
        return np.array(self._u).reshape(-1, dim)[order], np.array(self._fun, dtype=np.float64)[order]


def _distance(a: Array, b: Array) -> float:
    """Return the largest difference in any one parameter: a tolerance then means the same in every dimension."""
    return float(np.abs(a - b).max())
