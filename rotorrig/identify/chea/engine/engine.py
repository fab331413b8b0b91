"""`Engine`: the flow chart of Fig. 1, which every profile goes through with parts of its own.

Gather points in a box, cluster them, and search each cluster. Decide whether each is convex; gather again in the
reduced bounds of those that are not. Then go on in rounds, far from what is known or wherever else a profile expects
more, until the natural end. A box is an array (2, dim) of its lower and upper corner in the unit cube.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine.local_search import End, LocalSearch
from rotorrig.identify.chea.session import Evaluations, Record, Stop, StopReason, one_point

Array = NDArray[np.float64]
Index = NDArray[np.intp]

#: Rows of the gathered points, best first, of one cluster after another. A cluster is worked out when it is asked for,
#: so that what the search of one found may show in the next.
Clusters = Iterator[Index]
Step = Callable[["Engine"], Evaluations[None]]


def nothing(engine: Engine) -> Evaluations[None]:
    """Take no step."""
    yield from ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Method:
    """Parts of a search, in the order of their use."""

    #: Evaluate the first points of a box (2, dim), and return their clusters.
    gather: Callable[[Engine, Array], Evaluations[Clusters]]
    local: LocalSearch
    after: Step = nothing  # the search of a cluster
    members: int = 0  # of a cluster, beside the best, that are searched from before it counts as convex
    levels: int = 1  # of boxes: the whole, and so often reduced to a cluster that is not convex
    steps: tuple[Step, ...] = ()  # of a round, once the clusters are searched
    note: Callable[[Engine], None] = lambda engine: None  # looks at the minima whenever one was met
    is_over: Callable[[Engine], bool]  # the natural end, asked before every round
    finish: Step = nothing  # after the last one
    more: Step | None = None  # a round for minima that the natural end leaves unlisted; None: it knows none
    has_all: Callable[[Engine], bool] = lambda engine: False  # whether such rounds have come to their end


class Engine:
    """A search under way: its record, the points gathered, and the local searches begun there."""

    def __init__(self, record: Record, rng: np.random.Generator, method: Method) -> None:
        self.record = record
        self.rng = rng
        self.method = method
        self.rounds = 0
        self.descents = 0
        self.points = np.empty((0, record.dim))  # gathered, bred or far away: not those of descents
        self.values = np.empty(0)
        self.started = np.empty(0, dtype=np.bool_)  # whether a descent began there

    def run(self, stop: Stop = "natural") -> Evaluations[StopReason]:
        """Search until the natural end; beyond it, for more minima, if the method can."""
        more = self.method.more
        boxes = [np.stack([np.zeros(self.record.dim), np.ones(self.record.dim)])]
        for _ in range(self.method.levels):
            inner = []
            for box in boxes:
                clusters = yield from self.method.gather(self, box)
                inner += yield from self._reduce(box, clusters)
                if not np.isfinite(self.record.best[1]):
                    return StopReason.NO_FINITE_VALUE
            boxes = inner
            self.record.reduced += len(boxes)
            if not boxes:
                break
        while not self.method.is_over(self):
            for step in self.method.steps:
                yield from step(self)
            self.rounds += 1
        while more and (stop == "budget" or (stop == "all" and not self.method.has_all(self))):
            yield from more(self)
        yield from self.method.finish(self)
        return StopReason.STALLED if boxes else StopReason.CONVERGED

    def gather(self, points: Array) -> Evaluations[Index]:
        """Evaluate points (n, dim); return the rows (n,) they have among all gathered."""
        values = yield points
        return self.add(points, values)

    def add(self, points: Array, values: Array) -> Index:
        """Add points (n, dim) whose values (n,) are known to those gathered; return their rows."""
        self.points = np.vstack([self.points, points])
        self.values = np.append(self.values, values)
        self.started = np.append(self.started, np.zeros(len(points), dtype=np.bool_))
        return np.arange(len(self.values) - len(values), len(self.values))

    def search(self, clusters: Clusters) -> Evaluations[list[tuple[Index, Array]]]:
        """Descend from the best of every cluster; return the clusters with the listed minimum that led to."""
        searched = []
        for members in clusters:
            self.record.heads.append(self.points[members[0]])
            end = yield from self.descend_from(int(members[0]))
            searched.append((members, self._find_listed(end)))
            yield from self.method.after(self)
        return searched

    def _reduce(self, box: Array, clusters: Clusters) -> Evaluations[list[Array]]:
        """Search the clusters of a box; return the boxes of those that hold several minima.

        A lone cluster is never convex on the word of its best point alone: it gets the additional searches too. They
        end with the first that disagrees, which decides.
        """
        searched = yield from self.search(clusters)
        if not self.method.members:
            return []
        ends = [end for _, end in searched]
        if len(ends) > 1 and self._agree(ends):
            return []
        unresolved = []
        for members, end in searched:
            for row in self.rng.permutation(members[1:])[: self.method.members]:
                other = yield from self.descend_from(int(row))
                if not self._agree([end, self._find_listed(other)]):
                    unresolved.append(bounding_box(self.points[members], box))
                    break
        return unresolved

    def _find_listed(self, end: End) -> Array:
        """Return the listed minimum (dim,) nearest to the end of a descent, or that end if there is none."""
        listed, _, _ = self.record.minima.sorted()
        return listed[np.abs(listed - end.u).max(axis=1).argmin()] if len(listed) else end.u

    def _agree(self, ends: list[Array]) -> bool:
        return one_point(ends, self.record.minima.tolerance)

    def descend_from(self, row: int, *, radius: float | None = None) -> Evaluations[End]:
        """Descend from a gathered point."""
        self.started[row] = True
        return (yield from self.descend(self.points[row], float(self.values[row]), radius=radius))

    def descend(
        self, start: Array, value: float, *, radius: float | None = None, wary: bool = True
    ) -> Evaluations[End]:
        """Descend from `start` (dim,), where the function is `value`, and list what that leads to."""
        end = yield from self.method.local(self.record, start, value, radius=radius, wary=wary)
        if end.kind == "minimum" or (end.kind == "stuck" and end.fun <= self.record.best[1]):
            self.take_in(end)
        self.descents += 1
        self.record.step("local")
        return end

    def take_in(self, end: End) -> None:
        """List the end of a descent."""
        self.record.minima.add(end.u, end.fun)
        self.method.note(self)


def bounding_box(points: Array, box: Array) -> Array:
    """Return the box of a cluster's points (n, dim), a tenth wider to each side and of some width, within `box`."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = np.maximum(0.1 * (high - low), 0.01 * (box[1] - box[0]))
    return np.stack([np.maximum(low - margin, box[0]), np.minimum(high + margin, box[1])])
