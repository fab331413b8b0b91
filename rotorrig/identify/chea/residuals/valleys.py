"""`Valleys`: the minima of a sum of squares, each once, however far a flat valley floor extends."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.levenberg_marquardt import Point


class Valleys:
    """Ends of descents; one that explains the data as another does is that one, kept at its lowest.

    Ends are the same within `same_point` in every parameter, or where the linear model of the lower one has its
    residuals change by less than `same_fit` of its sum of squares: what tells them apart, the data do not determine.
    """

    def __init__(self, dim: int, *, same_point: float, same_fit: float) -> None:
        self._same_point = same_point
        self._same_fit = same_fit
        self.points: list[Point] = []
        self.cost = np.empty(0)  # (valley,)
        self.hits = np.empty(0, dtype=np.intp)  # (valley,) ends that were there
        self._u = np.empty((0, dim))
        self._normal = np.empty((0, dim, dim))

    @property
    def best(self) -> float:
        """The lowest sum of squares, +inf before the first."""
        return float(self.cost.min(initial=np.inf))

    def add(self, point: Point, *, hits: int = 1) -> None:
        """Take in the end of a descent, or of several."""
        same = np.flatnonzero(self._same(point))
        if not len(same):
            self.points.append(point)
            self.cost = np.append(self.cost, point.cost)
            self.hits = np.append(self.hits, hits)
            self._u = np.vstack([self._u, point.p])
            self._normal = np.concatenate([self._normal, point.normal[None]])
            return
        known = same[self.cost[same].argmin()]
        self.hits[known] += hits
        if point.cost < self.cost[known]:
            self.points[known], self.cost[known] = point, point.cost
            self._u[known], self._normal[known] = point.p, point.normal

    def holds(self, point: Point) -> bool:
        """Return whether a point is in a known valley, and no lower."""
        return bool((self._same(point) & (self.cost <= point.cost)).any())

    def _same(self, point: Point) -> NDArray[np.bool_]:
        away = point.p - self._u
        change = np.einsum("vi,vij,vj->v", away, self._normal, away)
        near = np.abs(away).max(axis=1) <= self._same_point
        return near | (change <= self._same_fit * self.cost)
