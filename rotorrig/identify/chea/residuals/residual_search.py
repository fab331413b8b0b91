"""CHEA for least squares, where one call gives the vector of residuals and its Jacobian.

The plan is the chapter's: gather, cluster, search each cluster, go on elsewhere, list all significant minima. The
vector makes each part cheap. A descent is Levenberg's and Marquardt's and takes some ten calls; a handful of points
shows enough of the ground; and a sum of squares has a bottom, so a minimum as small as rounding is the global one.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.levenberg_marquardt import (
    SEARCH,
    Counted,
    Minimum,
    Point,
    Progress,
    Residual,
    Stop,
    minimize_squares,
)
from rotorrig.identify.chea.residuals.valleys import Valleys
from rotorrig.identify.chea.session import StopReason
from rotorrig.identify.chea.steps import heads, spread

Array = NDArray[np.float64]
Watch = Callable[[Progress], Stop | None]
Starts = Callable[[Array], Array]  # points (n, dim) spread evenly over the cube -> where to begin, (n, dim)


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualSettings:
    """Control parameters. Lengths are in the unit cube, where every parameter runs from 0 to 1."""

    sample: int = 2  # points gathered first, per parameter
    mutants: int = 2  # starts between two looks at whether to stop
    mutation: float = 0.3  # probability that a mutant does not have a parameter of the best minimum
    reach: float = 0.25  # longest step in any parameter
    steps: int = 40  # calls of a descent
    rough: float = 1e-3  # a descent ends when a step promises less, of the cost
    fine: float = 1e-10  # so do the last ones, from the minima listed
    same_point: float = 0.02  # ends of descents this close are one minimum,
    same_fit: float = 0.01  # so are those whose residuals differ by this part of the cost
    significant: float = 4.0  # times the lowest cost: a minimum above explains nothing
    patience: int = 6  # steps in which a descent above that must lose `gain` of its cost
    gain: float = 0.3
    unseen: float = 0.03  # expected share of the basins not met, below which the search ends


#: One set of values for every problem.
RESIDUAL = ResidualSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualResult:
    """The significant minima, best first."""

    u: Array  # (minimum, dim)
    cost: Array  # (minimum,) r r
    hits: NDArray[np.intp]  # (minimum,) descents that ended there
    calls: int
    stop: StopReason


def residual_search(
    fun: Residual,
    dim: int,
    *,
    rng: np.random.Generator,
    floor: float = 0.0,
    starts: Starts = lambda points: points,
    max_calls: int = 2000,
    settings: ResidualSettings = RESIDUAL,
) -> ResidualResult:
    """List the significant minima of r r over the unit cube; `fun` returns r (figure,) and dr/du (figure, dim).

    The search ends at a cost of `floor` or less, where nothing is left to explain, with StopReason.TARGET. With noise
    it ends when the minima it keeps coming back to leave little room for others (StopReason.CONVERGED): of the cube,
    the basins not met are expected to hold W (W + 1) / (N (N - 1)) after N descents to W minima (Boender and Rinnooy
    Kan, "Bayesian stopping rules for multistart global optimization methods", Mathematical Programming 37, 1987). Many
    of these N begin near the best minimum, so the share measures effort rather than probability. `starts` bends evenly
    spread points towards where descents succeed. `fun` is called `max_calls` times at most.

    >>> def valley(u):
    ...     x, y = 4 * u - 2
    ...     return np.array([10 * (y - x**2), 1 - x]), 4 * np.array([[-20 * x, 10], [-1, 0]])
    >>> found = residual_search(valley, 2, rng=np.random.default_rng(0), floor=1e-16)
    >>> (4 * found.u[0] - 2).round(9).tolist(), str(found.stop)
    ([1.0, 1.0], 'target reached')
    """
    return _Search(fun, dim, rng=rng, floor=floor, starts=starts, max_calls=max_calls, settings=settings).run()


class _Search:
    def __init__(
        self,
        fun: Residual,
        dim: int,
        *,
        rng: np.random.Generator,
        floor: float,
        starts: Starts,
        max_calls: int,
        settings: ResidualSettings,
    ) -> None:
        self._fun = Counted(fun)
        self._dim = dim
        self._rng = rng
        self._floor = floor
        self._starts = starts
        self._max_calls = max_calls
        self._settings = settings
        self._steps = replace(SEARCH, reach=settings.reach)
        self._cube = np.zeros(dim), np.ones(dim)
        self._valleys = self._none()
        self._lowest: Point

    def run(self) -> ResidualResult:
        for start in self._beginnings():
            self._descend(start)
            if self._lowest.cost <= self._floor:
                break
        return self._result(self._reason())

    def _reason(self) -> StopReason:
        if not np.isfinite(self._lowest.cost):
            return StopReason.NO_FINITE_VALUE
        if self._lowest.cost <= self._floor:
            return StopReason.TARGET
        return StopReason.CONVERGED if self._enough() else StopReason.BUDGET

    def _beginnings(self) -> Iterator[Point]:
        """Yield where to descend from: the heads of the sample's clusters, then mutants while they may be of use.

        None when the calls are used up.
        """
        number = min(self._settings.sample * self._dim, self._max_calls)
        sample = [self._fun(u) for u in self._starts(spread(number, self._dim, self._rng))]
        costs = np.array([point.cost for point in sample])
        self._lowest = sample[costs.argmin()]
        if not np.isfinite(costs).any():
            return
        points = np.array([point.p for point in sample])
        yield from (sample[i] for i in heads(points, costs, neighbours=self._dim))
        while not self._enough():
            for _ in range(self._settings.mutants):
                if self._fun.calls >= self._max_calls:
                    return
                yield self._fun(self._mutant())

    def _mutant(self) -> Array:
        """Return the lowest point with one parameter or more drawn anew: rotors' axes act almost separately.

        Half of the time they are drawn from where descents succeed, half from the whole cube, the chapter's random
        search.
        """
        fresh = self._rng.random((1, self._dim))
        if self._rng.random() < 0.5:
            fresh = self._starts(fresh)
        mutated = self._rng.random(self._dim) < self._settings.mutation
        mutated[self._rng.integers(self._dim)] = True
        return np.where(mutated, fresh[0], self._lowest.p)

    def _descend(self, start: Point) -> None:
        if not np.isfinite(start.cost):
            return
        end = self._follow(start, share=self._settings.rough, watch=self._watch)
        if end.point.cost < self._lowest.cost:
            self._lowest = end.point
        if end.stop not in (Stop.GIVEN_UP, Stop.BUDGET):
            self._valleys.add(end.point)

    def _follow(self, start: Point, *, share: float, watch: Watch = lambda progress: None) -> Minimum:
        """Return the end of a descent."""
        return minimize_squares(
            self._fun,
            start,
            bounds=self._cube,
            settings=self._steps,
            share=share,
            max_calls=min(self._settings.steps, self._max_calls - self._fun.calls),
            watch=watch,
        )

    def _watch(self, progress: Progress) -> Stop | None:
        """End a descent where nothing is left to explain, at a known minimum, or where it lags behind too far."""
        settings, point, costs = self._settings, progress.point, progress.costs
        if point.cost <= self._floor or self._valleys.holds(point):
            return Stop.ENOUGH
        lags = len(costs) > settings.patience and point.cost > (1 - settings.gain) * costs[-1 - settings.patience]
        return Stop.GIVEN_UP if lags and point.cost > settings.significant * self._valleys.best else None

    def _enough(self) -> bool:
        """Return whether the basins not met are expected to be small enough."""
        significant = self._valleys.cost <= self._settings.significant * self._valleys.best
        minima, descents = int(significant.sum()), int(self._valleys.hits[significant].sum())
        return minima > 0 and minima * (minima + 1) <= self._settings.unseen * descents * (descents - 1)

    def _result(self, reason: StopReason) -> ResidualResult:
        """Return the significant minima, each followed down to its very bottom."""
        settings = self._settings
        if self._lowest.cost < self._valleys.best:  # of a descent that ran out of steps
            self._valleys.add(self._lowest)
        minima = self._none()
        for i in np.flatnonzero(self._valleys.cost <= max(settings.significant * self._valleys.best, self._floor)):
            end = self._valleys.points[i]
            bottom = end if reason is StopReason.TARGET else self._follow(end, share=settings.fine).point
            minima.add(bottom, hits=int(self._valleys.hits[i]))
        order = np.argsort(minima.cost, kind="stable")
        return ResidualResult(
            u=np.array([minima.points[i].p for i in order]).reshape(-1, self._dim),
            cost=minima.cost[order],
            hits=minima.hits[order],
            calls=self._fun.calls,
            stop=reason,
        )

    def _none(self) -> Valleys:
        return Valleys(self._dim, same_point=self._settings.same_point, same_fit=self._settings.same_fit)
