"""`Valleys`: the distance of minima by their residuals, however far a flat valley floor extends."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.norms import Norm
from rotorrig.identify.chea.residuals.point import Point

Array = NDArray[np.float64]


class Valleys:
    """Ends of descents, with their residuals; a point that explains the data as one of them does is in its place.

    It does where the linear model of the end has its residuals change by less than `same_fit` of its value: what tells
    the two apart, the data do not determine.
    """

    def __init__(self, norm: Norm, *, same_fit: float) -> None:
        self._norm = norm
        self._same_fit = same_fit
        self._ends: dict[bytes, Point] = {}

    def keep(self, end: Point) -> None:
        """Remember the end of a descent."""
        self._ends[end.p.tobytes()] = end

    def end(self, u: Array) -> Point:
        """Return the end that was kept at `u` (dim,)."""
        return self._ends[u.tobytes()]

    def distance(self, minima: Array, values: Array, u: Array) -> Array:
        """Return the distances (n,) of minima that were kept, (n, dim) with values (n,), to `u` (dim,).

        They are the largest differences in any parameter, but nil within a valley.
        """
        away = u - minima
        change = [self._norm.value(self.end(known).J @ step) for known, step in zip(minima, away, strict=True)]
        return np.where(np.array(change) <= self._same_fit * values, 0.0, np.abs(away).max(axis=1))
