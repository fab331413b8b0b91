"""Least sum of absolute values of a linear model within a box, corner by corner: a step of `least_absolute`.

In a corner as many planes meet as there are parameters: residuals that vanish there, and sides of the box. To leave one
of them while the others hold is to walk along an edge. The walk takes the edge that falls most for what it moves, and
passes every residual that changes its sign until the sum would rise (Barrodale and Roberts, SIAM J. Numer. Anal. 10,
1973; Bloomfield and Steiger, SIAM J. Sci. Stat. Comput. 1, 1980).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.settings import ABSOLUTE

Array = NDArray[np.float64]

_GOLDEN = (np.sqrt(5.0) - 1) / 2  # multiples of it, less their whole parts, are all apart
_TINY = np.finfo(float).tiny


def minimize_absolute_on_box(r: Array, J: Array, low: Array, high: Array) -> Array:
    """Return the step s (dim,) of least sum |r + J s| within low <= 0 <= high; J is (figure, dim).

    Where corners coincide the walk may go round in circles, as it does among small integers. After `ABSOLUTE.edges`
    edges per parameter the residuals are moved apart by up to `ABSOLUTE.apart` of the largest, and it begins anew. Nil
    if anything is not finite.

    >>> J = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])  # a median, and a side of the box
    >>> minimize_absolute_on_box(np.array([-0.2, -0.3, -0.9, -2.0]), J, -np.ones(2), np.ones(2)).tolist()
    [0.3, 1.0]
    """
    if not (np.isfinite(r).all() and np.isfinite(J).all()):
        return np.zeros(J.shape[1])
    s, ended = _walk(r, J, low, high)
    if not ended:
        spread = np.modf(np.arange(1, len(r) + 1) * _GOLDEN)[0]
        s, _ = _walk(r + ABSOLUTE.apart * np.abs(r).max() * spread, J, low, high)
    return s


def _walk(r: Array, J: Array, low: Array, high: Array) -> tuple[Array, bool]:
    """Walk from s = 0 to a corner without a falling edge; return it, or where the edges were used up, and False."""
    figures, dim = J.shape
    corner, s = _Corner(figures, dim), np.zeros(dim)
    for _ in range(ABSOLUTE.edges * dim):
        off = r + J @ s
        edge = corner.steepest(off, J)
        if edge is None:
            return np.clip(s, low, high), True
        residual, length = _turn(off, edge, corner.open[:figures])
        side, room = _way_out(s, edge.along, low, high)
        s = s + min(length, room) * edge.along
        if length <= room:
            corner.take(edge.place, residual, J[residual])
        else:
            s[side] = high[side] if edge.along[side] > 0 else low[side]
            corner.take_side(edge.place, side, inward=-np.sign(edge.along[side]))
    return np.clip(s, low, high), False


class _Edge(NamedTuple):
    """A way out of a corner along which the sum falls."""

    place: int  # of the plane that is left
    along: Array  # (dim,)
    rates: Array  # (figure,) change of every residual, per unit of `along`
    slope: float  # of the sum, negative


class _Corner:
    """The planes that meet where the walk is; at first those through the start, which cost nothing to leave."""

    def __init__(self, figures: int, dim: int) -> None:
        self._normals = np.eye(dim)
        self._plane = np.full(dim, -1)  # of each place: a residual, `figures` + a parameter for its side, -1
        self._rise = np.zeros(dim)  # 1 for a residual, which grows to either side of its plane
        self._inward = np.zeros(dim)  # for a side: the sign of the only way to leave it
        self.open = np.ones(figures + dim, dtype=bool)  # residuals, then sides, that do not meet here

    def steepest(self, off: Array, J: Array) -> _Edge | None:
        """Return the edge that falls most for what it moves, or None: this is the minimum."""
        edges = np.linalg.inv(self._normals)
        rates = J @ edges
        sign = np.where(off < 0, -1.0, 1.0) * self.open[: len(off)]  # one that is nil counts as just above
        slopes = sign @ rates
        way = np.where(self._inward == 0, np.where(slopes > 0, -1.0, 1.0), self._inward)
        slopes = way * slopes + self._rise
        shares = slopes / np.maximum(np.abs(J).sum(axis=0) @ np.abs(edges), _TINY)
        place = int(shares.argmin())
        if not shares[place] < -ABSOLUTE.level:
            return None
        along = way[place] * edges[:, place]
        held = ~self.open[len(off) :]
        if self._inward[place]:
            held[self._plane[place] - len(off)] = False
        along[held] = 0.0  # but for rounding it is
        return _Edge(place, along, way[place] * rates[:, place], float(slopes[place]))

    def take(self, place: int, residual: int, normal: Array) -> None:
        """Let a residual's plane take the place of another."""
        self._replace(place, residual, normal)
        self._rise[place] = 1.0

    def take_side(self, place: int, side: int, *, inward: float) -> None:
        """Let a side of the box take it."""
        dim = len(self._normals)
        self._replace(place, len(self.open) - dim + side, np.eye(dim)[side])
        self._inward[place] = inward

    def _replace(self, place: int, plane: int, normal: Array) -> None:
        if self._plane[place] >= 0:
            self.open[self._plane[place]] = True
        self._plane[place], self.open[plane] = plane, False
        self._normals[place], self._rise[place], self._inward[place] = normal, 0.0, 0.0


def _turn(off: Array, edge: _Edge, free: NDArray[np.bool_]) -> tuple[int, float]:
    """Return the residual at which the sum stops falling along an edge, and how far that is; infinity: nowhere."""
    speeds = np.where(off < 0, edge.rates, -edge.rates)
    crossing = np.flatnonzero(free & (speeds > ABSOLUTE.level * np.abs(edge.rates).max()))
    speeds = speeds[crossing]
    lengths = np.abs(off[crossing]) / speeds
    order = lengths.argsort(kind="stable")
    rising = np.flatnonzero(edge.slope + 2 * np.cumsum(speeds[order]) >= 0)
    if len(rising) == 0:
        return -1, np.inf
    last = order[rising[0]]
    return int(crossing[last]), float(lengths[last])


def _way_out(s: Array, along: Array, low: Array, high: Array) -> tuple[int, float]:
    """Return the parameter whose side of the box is the first in the way from `s`, and how far it is."""
    moving = np.flatnonzero(np.abs(along) > ABSOLUTE.still * np.abs(along).max())
    lengths = (np.where(along > 0, high, low)[moving] - s[moving]) / along[moving]
    first = int(lengths.argmin())
    return int(moving[first]), max(float(lengths[first]), 0.0)
