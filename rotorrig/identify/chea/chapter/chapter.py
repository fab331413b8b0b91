"""`profile="seed"`: the flow chart of Fig. 1, as the chapter has it.

A box is an array (2, dim) of its lower and upper corner in the unit cube.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.chapter.clustering import Clustering, cluster
from rotorrig.identify.chea.chapter.genetic import Colony
from rotorrig.identify.chea.chapter.settings import SEED, SeedSettings
from rotorrig.identify.chea.session import Evaluations, Record, StopReason, one_point
from rotorrig.identify.chea.steps import descend, farthest

__all__ = ["SEED", "search"]

Array = NDArray[np.float64]


def search(record: Record, rng: np.random.Generator, settings: SeedSettings) -> Evaluations[StopReason]:
    """Reduce boxes until every cluster holds one minimum, then search far from all points (Fig. 1)."""
    return (yield from _FlowChart(record, rng, settings).run())


class _FlowChart:
    def __init__(self, record: Record, rng: np.random.Generator, settings: SeedSettings) -> None:
        self._record = record
        self._rng = rng
        self._settings = settings

    def run(self) -> Evaluations[StopReason]:
        boxes = [np.stack([np.zeros(self._record.dim), np.ones(self._record.dim)])]
        for _ in range(self._settings.max_levels):
            inner = []
            for box in boxes:
                inner += yield from self._explore(box)
                if not np.isfinite(self._record.best[1]):
                    return StopReason.NO_FINITE_VALUE
            boxes = inner
            if not boxes:
                break
        yield from self._search_far()
        return StopReason.STALLED if boxes else StopReason.CONVERGED

    def _explore(self, box: Array) -> Evaluations[list[Array]]:
        """Search one box; return the boxes of those of its clusters that hold several minima.

        A lone cluster is never convex on the word of its best individual alone: it gets the additional searches too.
        They end with the first that disagrees, which decides.
        """
        points, fun, clusters = yield from self._ga_clustering(box)
        ends = []
        for members in clusters:
            ends.append((yield from self._descend(points[members[0]], fun[members[0]])))
        if len(clusters) > 1 and self._agree(ends):
            return []
        unresolved = []
        for end, members in zip(ends, clusters, strict=True):
            for i in self._rng.permutation(members[1:])[: self._settings.members]:
                other = yield from self._descend(points[i], fun[i])
                if not self._agree([end, other]):
                    unresolved.append(_bounding_box(points[members], box))
                    break
        return unresolved

    def _ga_clustering(self, box: Array) -> Evaluations[tuple[Array, Array, list[NDArray[np.intp]]]]:
        """Breed until eq. (1) calls the clusters mature; return points (n, dim), values (n,) and clusters, best first.

        The points returned are distinct: a population near maturity is mostly copies, and local searches from copies
        of one point agree whatever the function.
        """
        colony = Colony(box, rng=self._rng, settings=self._settings)
        yield from colony.create_founders()
        while True:
            self._record.step("genetic")
            order = _finite_best_first(colony.fun)
            points, fun = colony.points[order], colony.fun[order]
            if not len(points):
                return points, fun, []
            clustering = cluster((points - box[0]) / (box[1] - box[0]), self._settings)
            if clustering.cef < self._settings.cef_stop or colony.generation == self._settings.max_generations:
                return points, fun, [_without_copies(points, members) for members in clustering.members()]
            yield from colony.advance(order[self._elites(clustering)])

    def _elites(self, clustering: Clustering) -> NDArray[np.intp]:
        """Return the best of all, and of each cluster that is no mere stray; individuals are best first.

        The chapter is silent on elitism. With the best of all alone a peak is lost by chance to another as high, and
        less is left to agree: eq. (3) takes 16 % more calls, eq. (4) 7 %.
        """
        firsts = [members[0] for members in clustering.members() if len(members) >= self._settings.min_cluster_size]
        return np.unique([0, *firsts])

    def _agree(self, ends: list[Array]) -> bool:
        return one_point(ends, self._settings.same_point)

    def _descend(self, start: Array, value: float) -> Evaluations[Array]:
        """Return the listed minimum a local search leads to; it is not followed all the way if it is known already.

        Followed to their ends, the searches on eqs. (2) to (4) take 3, 19 and 21 % more calls in all.
        """
        u, fun = yield from descend(self._record, start, value, near=self._settings.same_point)
        self._record.minima.add(u, fun)
        self._record.step("local")
        listed, _, _ = self._record.minima.sorted()
        return listed[np.abs(listed - u).max(axis=1).argmin()]

    def _search_far(self) -> Evaluations[None]:
        """Section 2.5; after a local search the steps go on, to the maximum number of iterations."""
        for _ in range(self._settings.far_iterations):
            candidates = self._rng.random((self._settings.far_candidates, self._record.dim))
            point = farthest(candidates, self._record.points)
            value = float((yield point[None])[0])
            if value < self._record.minima.best:
                yield from self._descend(point, value)
        self._record.step("far")


def _finite_best_first(fun: Array) -> NDArray[np.intp]:
    order = np.argsort(fun, kind="stable")
    return order[np.isfinite(fun[order])]


def _without_copies(points: Array, members: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the members whose point is the first of its kind, in the order given (best first)."""
    first = np.unique(points[members], axis=0, return_index=True)[1]
    return members[np.sort(first)]


def _bounding_box(points: Array, box: Array) -> Array:
    """Return the box of a cluster's points (n, dim), a tenth wider to each side and of some width, within `box`."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = np.maximum(0.1 * (high - low), 0.01 * (box[1] - box[0]))
    return np.stack([np.maximum(low - margin, box[0]), np.minimum(high + margin, box[1])])
