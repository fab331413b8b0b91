"""`chea`: global minimisation by the clustering-based hybrid evolutionary algorithm.

After the chapter "A Hybrid Evolutionary Algorithm and its Application to Parameter Identification of Rolling Elements
Bearings", sections 2 and 3; its source for the algorithm itself is Kim et al. (2006).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds

from rotorrig.identify.chea.clustering import cluster
from rotorrig.identify.chea.far_search import farthest
from rotorrig.identify.chea.genetic import Colony
from rotorrig.identify.chea.ledger import Callback, Ledger
from rotorrig.identify.chea.local_search import descend
from rotorrig.identify.chea.minima import Minima, one_point
from rotorrig.identify.chea.result import CheaResult, assemble
from rotorrig.identify.chea.scaling import from_bounds
from rotorrig.identify.chea.settings import SEED, Settings
from rotorrig.identify.chea.stopping import Halt, StopReason

Array = NDArray[np.float64]


def chea(
    fun: Callable[[Array], Any],
    bounds: Bounds | Sequence[ArrayLike],
    *,
    rng: np.random.Generator,
    x_scale: str | Sequence[str] = "linear",
    max_nfev: int = 10_000,
    f_target: float | None = None,
    vectorized: bool = False,
    callback: Callback | None = None,
    settings: Settings = SEED,
) -> CheaResult:
    """Minimise `fun` within `bounds`, and list the local minima met on the way.

    `fun` takes the parameters (dim,) and returns a number; with `vectorized` it takes (n, dim) and returns (n,), a
    generation or a finite-difference gradient at a time. It is never called outside `bounds`, scipy's `Bounds` or
    (dim, 2), nor more than `max_nfev` times, finite differences included. A value that is not finite, or an exception,
    counts as a call and as +inf. `x_scale` is "linear" or "log", for all parameters or one by one: on a logarithmic
    scale the search, its distances and its tolerances are in decades. Given the same `rng`, the search is the same.

    The search ends with the flow chart, at `f_target` (the best is at or below it), at the budget, on Ctrl-C, or when
    `callback` raises StopIteration; `callback(result)` sees x, fun, nfev, nit and stage ("genetic", "local", "far") of
    the best so far after each generation, local search and far search.

    Raises ValueError on unusable bounds, scale or budget, TypeError when `fun` returns no number.

    Measured over 100 seeds (benchmarks/chea_tables.py), mean calls and success, the chapter's in brackets: eq. (2)
    1344, 100 % (1120); eq. (3) with all four global minima 1902, 100 % (1131); eq. (4) 2836, 95 % (2100, 99 %), and on
    a box shifted at random 2785, 90 %. 400 of the calls are the far search. A failure is quiet: each cluster held one
    minimum, and none of them was the global one.

    >>> found = chea(lambda x: (x[0] - 3) ** 2 + (x[1] - 1) ** 2, [(-5, 5), (-5, 5)], rng=np.random.default_rng(1))
    >>> found.x.round(4).tolist(), str(found.stop_reason)
    ([3.0, 1.0], 'converged')
    """
    if max_nfev < 1:
        raise ValueError(f"max_nfev is {max_nfev}, expected at least 1")
    ledger = Ledger(
        fun,
        from_bounds(bounds, x_scale),
        max_nfev=max_nfev,
        f_target=f_target,
        vectorized=vectorized,
        callback=callback,
    )
    search = _Search(ledger, rng=rng, settings=settings)
    try:
        reason = search.run()
    except Halt as halt:
        reason = halt.reason
    except KeyboardInterrupt:
        reason = StopReason.INTERRUPTED
    return assemble(ledger, search.minima, reason)


class _Search:
    """The flow chart, Fig. 1, in the unit cube: a box is an array (2, dim) of its lower and upper corner."""

    def __init__(self, ledger: Ledger, *, rng: np.random.Generator, settings: Settings) -> None:
        self.minima = Minima(settings.same_point)
        self._ledger = ledger
        self._rng = rng
        self._settings = settings

    def run(self) -> StopReason:
        """Reduce boxes until every cluster holds one minimum, then search far from all points."""
        boxes = [np.stack([np.zeros(self._ledger.scaling.dim), np.ones(self._ledger.scaling.dim)])]
        for _ in range(self._settings.max_levels):
            boxes = [inner for box in boxes for inner in self._explore(box)]
            if not boxes:
                break
        self._search_far()
        return StopReason.STALLED if boxes else StopReason.CONVERGED

    def _explore(self, box: Array) -> list[Array]:
        """Search one box; return the boxes of those of its clusters that hold several minima.

        A lone cluster is never convex on the word of its best individual alone: it gets the additional searches too.
        """
        points, fun, clusters = self._ga_clustering(box)
        ends = [self._descend(points[members[0]], fun[members[0]]) for members in clusters]
        if len(clusters) > 1 and self._agree(ends):
            return []
        unresolved = []
        for end, members in zip(ends, clusters, strict=True):
            others = self._rng.permutation(members[1:])[: self._settings.members]
            if not self._agree([end, *(self._descend(points[i], fun[i]) for i in others)]):
                unresolved.append(_around(points[members], box))
        return unresolved

    def _ga_clustering(self, box: Array) -> tuple[Array, Array, list[NDArray[np.intp]]]:
        """Breed until eq. (1) calls the clusters mature; return points (n, dim), values (n,) and clusters, best first.

        The points returned are distinct: a population near maturity is mostly copies, and local searches from copies
        of one point agree whatever the function.
        """
        colony = Colony(self._ledger.evaluate, box, rng=self._rng, settings=self._settings)
        if not np.isfinite(self._ledger.best_fun):
            raise Halt(StopReason.NO_FINITE_VALUE)
        while True:
            self._ledger.report("genetic")
            points, fun = _finite_best_first(colony)
            if not len(points):
                return points, fun, []
            found = cluster((points - box[0]) / (box[1] - box[0]), self._settings)
            if found.cef < self._settings.cef_stop or colony.generation == self._settings.max_generations:
                return points, fun, [_without_copies(points, members) for members in found.members()]
            colony.advance()

    def _agree(self, ends: list[Array]) -> bool:
        return one_point(ends, self._settings.same_point)

    def _descend(self, start: Array, value: float) -> Array:
        u, fun = descend(self._ledger.evaluate, start, value)
        self.minima.add(u, fun)
        self._ledger.report("local")
        return u

    def _search_far(self) -> None:
        """Section 2.5; after a local search the steps go on, to the maximum number of iterations."""
        for _ in range(self._settings.far_iterations):
            candidates = self._rng.random((self._settings.far_candidates, self._ledger.scaling.dim))
            point = farthest(candidates, self._ledger.points)
            value = float(self._ledger.evaluate(point[None])[0])
            if value < self.minima.best:
                self._descend(point, value)
        self._ledger.report("far")


def _finite_best_first(colony: Colony) -> tuple[Array, Array]:
    order = np.argsort(colony.fun, kind="stable")
    order = order[np.isfinite(colony.fun[order])]
    return colony.points[order], colony.fun[order]


def _without_copies(points: Array, members: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the members whose point is the first of its kind, in the order given (best first)."""
    first = np.unique(points[members], axis=0, return_index=True)[1]
    return members[np.sort(first)]


def _around(points: Array, box: Array) -> Array:
    """Return the box of a cluster's points (n, dim), a tenth wider to each side and of some width, within `box`."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = np.maximum(0.1 * (high - low), 0.01 * (box[1] - box[0]))
    return np.stack([np.maximum(low - margin, box[0]), np.minimum(high + margin, box[1])])
