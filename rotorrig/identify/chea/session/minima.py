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
    return bool((_distances(np.array(points), points[0]) <= tolerance).all())


class Minima:
    """Ends of local searches; those within `tolerance` of one another are one minimum, kept at its lowest."""

    def __init__(self, dim: int, *, tolerance: float) -> None:
        self.tolerance = tolerance
        self._u = np.empty((0, dim))
        self._fun = np.empty(0)
        self._hits = np.empty(0, dtype=np.intp)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._fun)

    @property
    def best(self) -> float:
        """The lowest value found, +inf before the first."""
        return float(self._fun.min(initial=np.inf))

    def add(self, u: Array, fun: float) -> None:
        """Take in the end of a local search at `u` (dim,) of the unit cube."""
        away = _distances(self._u, u)
        if not (away <= self.tolerance).any():
            self._u = np.vstack([self._u, u])
            self._fun = np.append(self._fun, fun)
            self._hits = np.append(self._hits, 1)
            return
        known = away.argmin()
        self._hits[known] += 1
        if fun < self._fun[known]:
            self._u[known], self._fun[known] = u, fun

    def sorted(self) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return the points (n, dim) in the unit cube, their values and how often each was met, (n,), best first."""
        order = np.argsort(self._fun, kind="stable")
        return self._u[order], self._fun[order], self._hits[order]


def _distances(points: Array, u: Array) -> Array:
    """Return the largest difference in any one parameter (n,): a tolerance then means the same in every dimension."""
    return np.abs(points - u).max(axis=1)
