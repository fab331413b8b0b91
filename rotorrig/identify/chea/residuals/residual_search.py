"""CHEA for least squares, where one call gives the vector of residuals and its Jacobian.

The engine is that of the other profiles: gather, cluster, search each cluster, go on elsewhere, list all significant
minima. The vector makes each part cheap. A descent is Levenberg's and Marquardt's and takes some ten calls; a handful
of points shows enough of the ground; and a sum of squares has a bottom, so a minimum as small as rounding is the global
one.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import Engine
from rotorrig.identify.chea.residuals.norms import SQUARES, Norm
from rotorrig.identify.chea.residuals.point import Counted, Residual
from rotorrig.identify.chea.residuals.vector import RESIDUAL, ResidualSettings, Starts, Vector
from rotorrig.identify.chea.session import Evaluations, Record, Stage, StopReason

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualResult:
    """The significant minima, best first."""

    u: Array  # (minimum, dim)
    cost: Array  # (minimum,) r r, or the sum of absolute values
    hits: NDArray[np.intp]  # (minimum,) descents that ended there
    calls: int
    stop: StopReason
    stages: tuple[Stage, ...]  # what each kind of step did, in the order they began
    heads: Array  # (n, dim) best points of the clusters that were searched
    points: Array  # (calls, dim)


def residual_search(
    fun: Residual,
    dim: int,
    *,
    rng: np.random.Generator,
    floor: float = 0.0,
    starts: Starts = lambda points: points,
    max_calls: int = 2000,
    settings: ResidualSettings = RESIDUAL,
    norm: Norm = SQUARES,
) -> ResidualResult:
    """List the significant minima of r r over the unit cube; `fun` returns r (figure,) and dr/du (figure, dim).

    With `norm=ABSOLUTES` they are those of the sum of |r|, and descents go by linear programs. The search ends at a
    cost of `floor` or less, where nothing is left to explain, with StopReason.TARGET. With noise it ends when the
    minima it keeps coming back to leave little room for others (StopReason.CONVERGED): of the cube, the basins not met
    are expected to hold W (W + 1) / (N (N - 1)) after N descents to W minima (Boender and Rinnooy Kan, "Bayesian
    stopping rules for multistart global optimization methods", Mathematical Programming 37, 1987). Many of these N
    begin near the best minimum, so the share measures effort rather than probability. `starts` bends evenly spread
    points towards where descents succeed. `fun` is called `max_calls` times at most.

    >>> def valley(u):
    ...     x, y = 4 * u - 2
    ...     return np.array([10 * (y - x**2), 1 - x]), 4 * np.array([[-20 * x, 10], [-1, 0]])
    >>> found = residual_search(valley, 2, rng=np.random.default_rng(0), floor=1e-16)
    >>> (4 * found.u[0] - 2).round(9).tolist(), str(found.stop)
    ([1.0, 1.0], 'target reached')
    """
    vector = Vector(Counted(fun), norm, starts, settings)
    record = Record(dim, minima=vector.no_minima(dim))
    stop = _run(Engine(record, rng, vector.method).run(), vector, record, floor=floor, max_calls=max_calls)
    u, lowest = record.best
    if lowest < record.minima.best:  # of a descent that was not over
        record.minima.add(u.copy(), lowest)
    places, cost, hits = record.minima.sorted()
    listed = cost <= max(settings.significant * lowest, floor)
    return ResidualResult(
        u=places[listed],
        cost=cost[listed],
        hits=hits[listed],
        calls=record.nfev,
        stop=stop,
        stages=record.stages,
        heads=np.array(record.heads).reshape(-1, dim),
        points=record.points,
    )


def _run(plan: Evaluations[StopReason], vector: Vector, record: Record, *, floor: float, max_calls: int) -> StopReason:
    """Answer what the search asks, point by point, until something ends it."""
    try:
        asked = next(plan)
        while True:
            for u in asked:
                if record.nfev == max_calls:
                    return StopReason.BUDGET
                record.add(u[None], np.array([vector(u)]))
                if record.best[1] <= floor:
                    return StopReason.TARGET
            asked = plan.send(record.values[record.nfev - len(asked) :].copy())
    except StopIteration as end:
        return end.value
