"""`Minima`: the local minima found, each once."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Distance = Callable[[Array, Array, Array], Array]  # from minima (n, dim) with values (n,) to a point (dim,) -> (n,)


def one_point(points: Sequence[Array], tolerance: float) -> bool:
    """Return whether all points (dim,) lie within `tolerance` of the first, "nearly the same point" of section 2.

    >>> one_point([np.zeros(2), np.array([0.0, 0.005])], 0.01)
    True
    """
    return bool((_distances(np.array(points), points[0]) <= tolerance).all())


class Minima:
    """Ends of local searches; those within `tolerance` of one another are one minimum, kept at its lowest."""

    def __init__(self, dim: int, *, tolerance: float, distance: Distance | None = None) -> None:
        """`distance` is by default the largest difference in any one parameter."""
        self.tolerance = tolerance
        self._distance = distance or (lambda points, _, u: _distances(points, u))
        self._u = np.empty((0, dim))
        self._fun = np.empty(0)
        self._hits = np.empty(0, dtype=np.intp)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._fun)

    @property
    def points(self) -> Array:
        """Where they are (n, dim), in the order they were found."""
        return self._u

    @property
    def best(self) -> float:
        """The lowest value found, +inf before the first."""
        return float(self._fun.min(initial=np.inf))

    def holds(self, u: Array, fun: float) -> bool:
        """Return whether a point is at a known minimum, and no lower."""
        return bool(((self._distance(self._u, self._fun, u) <= self.tolerance) & (self._fun <= fun)).any())

    def add(self, u: Array, fun: float, *, hits: int = 1) -> None:
        """Take in the end of a local search, or of several, at `u` (dim,) of the unit cube."""
        away = self._distance(self._u, self._fun, u)
        if not (away <= self.tolerance).any():
            self._u = np.vstack([self._u, u])
            self._fun = np.append(self._fun, fun)
            self._hits = np.append(self._hits, hits)
            return
        known = away.argmin()
        self._hits[known] += hits
        if fun < self._fun[known]:
            self._u[known], self._fun[known] = u, fun

    def sorted(self) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return the points (n, dim) in the unit cube, their values and how often each was met, (n,), best first."""
        order = np.argsort(self._fun, kind="stable")
        return self._u[order], self._fun[order], self._hits[order]


def _distances(points: Array, u: Array) -> Array:
    """Return the largest difference in any one parameter (n,): a tolerance then means the same in every dimension."""
    return np.abs(points - u).max(axis=1)
