"""`chea`: global minimisation by the clustering-based hybrid evolutionary algorithm.

B.-S. Yang, Y.-H. Kim et al., "A Hybrid Evolutionary Algorithm and its Application to Parameter Identification of
Rolling Elements Bearings", sections 2 and 3.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds, OptimizeResult

from rotorrig.identify.chea.clustering import cluster
from rotorrig.identify.chea.far_search import farthest
from rotorrig.identify.chea.genetic import Colony
from rotorrig.identify.chea.ledger import Callback, Ledger
from rotorrig.identify.chea.local_search import descend
from rotorrig.identify.chea.minima import Minima, one_point
from rotorrig.identify.chea.scaling import from_bounds
from rotorrig.identify.chea.settings import Settings
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
    settings: Settings | None = None,
) -> OptimizeResult:
    settings = settings or Settings()
    ledger = Ledger(
        fun,
        from_bounds(bounds, x_scale),
        max_nfev=max_nfev,
        f_target=f_target,
        vectorized=vectorized,
        callback=callback,
    )
    search = _Search(ledger, rng, settings)
    try:
        reason = search.run()
    except Halt as halt:
        reason = halt.reason
    except KeyboardInterrupt:
        reason = StopReason.INTERRUPTED
    return _result(ledger, search.minima, reason)


class _Search:
    """The flow chart, Fig. 1."""

    def __init__(self, ledger: Ledger, rng: np.random.Generator, settings: Settings) -> None:
        self._ledger = ledger
        self._rng = rng
        self._settings = settings
        self.minima = Minima(settings.same_point)

    def run(self) -> StopReason:
        boxes = [np.array([np.zeros(self._ledger.scaling.dim), np.ones(self._ledger.scaling.dim)])]
        for _ in range(self._settings.max_levels):
            boxes = [inner for box in boxes for inner in self._explore(box)]
            if not boxes:
                break
        self._search_far()
        return StopReason.STALLED if boxes else StopReason.CONVERGED

    def _explore(self, box: Array) -> list[Array]:
        points, fun, groups = self._ga_clustering(box)
        firsts = [self._descend(points[g[0]], fun[g[0]]) for g in groups]
        if len(groups) > 1 and one_point(firsts, self._settings.same_point):
            return []
        unresolved = []
        for first, group in zip(firsts, groups, strict=True):
            others = self._rng.permutation(_distinct(points, group)[1:])[: self._settings.members]
            ends = [first, *(self._descend(points[i], fun[i]) for i in others)]
            if not one_point(ends, self._settings.same_point):
                unresolved.append(_around(points[group], box))
        return unresolved

    def _ga_clustering(self, box: Array) -> tuple[Array, Array, list[NDArray[np.intp]]]:
        colony = Colony(self._ledger.evaluate, box, rng=self._rng, settings=self._settings)
        if not np.isfinite(self._ledger.best_fun):
            raise Halt(StopReason.NO_FINITE_VALUE)
        while True:
            self._ledger.report("genetic")
            order = np.argsort(colony.fun, kind="stable")
            order = order[np.isfinite(colony.fun[order])]
            points, fun = colony.points[order], colony.fun[order]
            c = cluster((points - box[0]) / (box[1] - box[0]), self._settings)
            if c.cef < self._settings.cef_stop or colony.generation == self._settings.max_generations:
                return points, fun, c.members()
            colony.advance()

    def _descend(self, start: Array, value: float) -> Array:
        u, fun = descend(self._ledger.evaluate, start, value)
        self.minima.add(u, fun)
        self._ledger.report("local")
        return u

    def _search_far(self) -> None:
        for _ in range(self._settings.far_iterations):
            candidates = self._rng.random((self._settings.far_candidates, self._ledger.scaling.dim))
            u = farthest(candidates, self._ledger.points)
            f = float(self._ledger.evaluate(u[None])[0])
            if f < self.minima.best:
                self._descend(u, f)
        self._ledger.report("far")


def _distinct(points, group):
    return group[np.sort(np.unique(points[group], axis=0, return_index=True)[1])]


def _around(points: Array, box: Array) -> Array:
    low, high = points.min(axis=0), points.max(axis=0)
    pad = np.maximum(0.1 * (high - low), 0.01 * (box[1] - box[0]))
    return np.array([np.maximum(low - pad, box[0]), np.minimum(high + pad, box[1])])


def _result(ledger: Ledger, minima: Minima, reason: StopReason) -> OptimizeResult:
    u, funl = minima.sorted(ledger.scaling.dim)
    return OptimizeResult(
        x=ledger.best_x,
        fun=ledger.best_fun,
        nfev=ledger.nfev,
        nit=ledger.nit,
        xl=ledger.scaling.to_parameters(u),
        funl=funl,
        stop_reason=reason,
        status=reason.status,
        success=reason in (StopReason.CONVERGED, StopReason.TARGET),
        history=np.array(ledger.history),
        message=reason.value,
    )
