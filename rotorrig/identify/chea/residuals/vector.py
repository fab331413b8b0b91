"""The search by residual vectors: its parts, and the answers behind the values that the engine is told."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import Clusters, End, Engine, Method, nearest_better
from rotorrig.identify.chea.residuals.levenberg_marquardt import Stop
from rotorrig.identify.chea.residuals.norms import Norm, Watch
from rotorrig.identify.chea.residuals.point import Evaluate, Point
from rotorrig.identify.chea.residuals.valleys import Valleys
from rotorrig.identify.chea.session import Evaluations, Minima, Record
from rotorrig.identify.chea.steps import spread

Array = NDArray[np.float64]
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


class Vector:
    """The search's parts, and the points with residuals that descents go by."""

    def __init__(self, evaluate: Evaluate, norm: Norm, starts: Starts, settings: ResidualSettings) -> None:
        self._evaluate = evaluate
        self._norm = norm
        self._starts = starts
        self._settings = settings
        self._answers: dict[bytes, Point] = {}  # not descended from yet
        self._valleys = Valleys(norm, same_fit=settings.same_fit)

    @property
    def method(self) -> Method:
        """The parts, for the engine."""
        return Method(
            gather=self.gather, local=self.descend, steps=(self.mutate,), is_over=self.is_over, finish=self.finish
        )

    def no_minima(self, dim: int) -> Minima:
        """Return an empty list of minima, which are apart where their residuals are."""
        return Minima(dim, tolerance=self._settings.same_point, distance=self._valleys.distance)

    def __call__(self, u: Array) -> float:
        """Return the value at `u` (dim,); its residuals are kept until a descent takes them."""
        point = self._answers[u.tobytes()] = self._evaluate(u)
        return self._norm.value(point.r)

    def gather(self, engine: Engine, box: Array) -> Evaluations[Clusters]:
        """Evaluate a handful of points: with their derivatives, they show enough of the ground."""
        points = spread(self._settings.sample * engine.record.dim, engine.record.dim, engine.rng)
        yield from engine.gather(box[0] + (box[1] - box[0]) * self._starts(points))
        engine.record.step("gather")
        return nearest_better(engine, neighbours=engine.record.dim)

    def mutate(self, engine: Engine) -> Evaluations[None]:
        """Descend from the lowest point with one parameter or more drawn anew: rotors' axes act almost separately.

        Half of the time they are drawn from where descents succeed, half from the whole cube, the chapter's random
        search.
        """
        for _ in range(self._settings.mutants):
            fresh = engine.rng.random((1, engine.record.dim))
            if engine.rng.random() < 0.5:
                fresh = self._starts(fresh)
            mutated = engine.rng.random(engine.record.dim) < self._settings.mutation
            mutated[engine.rng.integers(engine.record.dim)] = True
            start = np.where(mutated, fresh[0], engine.record.best[0])
            value = float((yield start[None])[0])
            if np.isfinite(value):
                yield from engine.descend(start, value)

    def descend(
        self, record: Record, start: Array, value: float, *, radius: float | None, wary: bool
    ) -> Evaluations[End]:
        """Descend to the rough; wary, not to a known minimum, nor on where it lags behind too far."""
        settings = self._settings

        def watch(point: Point, values: Sequence[float]) -> Stop | None:
            if record.minima.holds(point.p, values[-1]):
                return Stop.ENOUGH
            lags = len(values) > settings.patience and values[-1] > (1 - settings.gain) * values[-1 - settings.patience]
            return Stop.GIVEN_UP if lags and values[-1] > settings.significant * record.minima.best else None

        return (yield from self._follow(self._answers.pop(start.tobytes()), share=settings.rough, watch=watch))

    def _follow(self, start: Point, *, share: float, watch: Watch = lambda point, values: None) -> Evaluations[End]:
        """Return the end of a descent, whose points the engine has evaluated."""
        settings = self._settings
        descent = self._norm.descend(start, reach=settings.reach, share=share, max_calls=settings.steps, watch=watch)
        try:
            u = next(descent)
            while True:
                yield u[None]
                u = descent.send(self._answers.pop(u.tobytes()))
        except StopIteration as end:
            point, stop = end.value
        self._valleys.keep(point)
        unfinished = stop in (Stop.GIVEN_UP, Stop.BUDGET)
        return End(u=point.p, fun=self._norm.value(point.r), kind="abandoned" if unfinished else "minimum")

    def is_over(self, engine: Engine) -> bool:
        """Return whether the basins not met are expected to be small enough."""
        _, fun, hits = engine.record.minima.sorted()
        significant = fun <= self._settings.significant * engine.record.minima.best
        minima, descents = int(significant.sum()), int(hits[significant].sum())
        return minima > 0 and minima * (minima + 1) <= self._settings.unseen * descents * (descents - 1)

    def finish(self, engine: Engine) -> Evaluations[None]:
        """Follow every significant minimum down to its very bottom."""
        settings, record = self._settings, engine.record
        bottoms = self.no_minima(record.dim)
        for u, fun, hits in zip(*record.minima.sorted(), strict=True):
            if fun <= settings.significant * record.minima.best:
                end = yield from self._follow(self._valleys.end(u), share=settings.fine)
                bottoms.add(end.u, end.fun, hits=int(hits))
        record.minima = bottoms
