"""`MoreMinima`: rounds beyond the natural end, for whoever wants every minimum as low as the best.

Three ways in turn, each with as many calls as the others in the long run. An even sample of its own, finer from round
to round, whose clusters are descended from: minima with basins of some size. Offspring of the lowest minima: those of a
pattern. Hops from the lowest minimum of every valley of the listed ones (nearest-better clustering, of minima instead
of points): those at the bottom of a rugged valley. What is known costs little: a descent that makes for a known minimum
is given up.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import End, Engine
from rotorrig.identify.chea.modern.recombination import offspring
from rotorrig.identify.chea.modern.settings import ModernSettings
from rotorrig.identify.chea.session import Evaluations
from rotorrig.identify.chea.steps import heads, spread

Array = NDArray[np.float64]
Way = Callable[[Engine], Evaluations[None]]


@dataclass(slots=True)
class _Valley:
    """The lowest minimum of a valley, and the hops from it."""

    u: Array
    fun: float
    length: float  # of the next hop
    hops: int = 0  # since it became the lowest


class MoreMinima:
    """What the rounds remember of one another."""

    def __init__(self, dim: int, settings: ModernSettings, margin: Callable[[Engine], float]) -> None:
        """`margin` is how far above the best value a minimum may lie to count as one as low."""
        self._settings = settings
        self._margin = margin
        self._neighbours = dim + settings.neighbours
        self._rounds = 0
        self._tried = np.empty((0, dim))  # offspring
        self._valleys: list[_Valley] = []
        self._sorted = 0  # minima, when valleys were last looked for
        self._ways: tuple[Way, ...] = (self._sample, self._breed, self._hop)
        self._spent = [0, 0, 0]  # calls, by way
        self._lowest = 0  # minima as low as the best, when there were last more of them
        self._last_find = 0  # calls until then

    def search(self, engine: Engine) -> Evaluations[None]:
        """Go the way that has cost least until now."""
        way = int(np.argmin(self._spent))
        before = engine.record.nfev
        yield from self._ways[way](engine)
        spent = engine.record.nfev - before
        self._spent[way] = self._spent[way] + spent if spent else max(self._spent) + 1  # nothing to do: others first
        number = len(self._as_low_as_the_best(engine)[0])
        if number > self._lowest:
            self._last_find = engine.record.nfev
        self._lowest = number

    def has_all(self, engine: Engine) -> bool:
        """Return whether all ways have been gone for long without a find."""
        idle = engine.record.nfev - self._last_find
        least = self._settings.idle_for_all * (engine.record.dim + 1)
        return min(self._spent) > 0 and idle > max(least, self._settings.patience_for_all * self._last_find)

    def _as_low_as_the_best(self, engine: Engine) -> tuple[Array, Array]:
        """Return the minima (n, dim) as low as the best, and their values (n,)."""
        u, fun, _ = engine.record.minima.sorted()
        low = fun <= engine.record.minima.best + self._margin(engine)
        return u[low], fun[low]

    def _sample(self, engine: Engine) -> Evaluations[None]:
        """Descend from the clusters of an even sample."""
        dim = engine.record.dim
        doubled = 2 ** min(self._rounds, self._settings.doublings)
        points = spread(self._settings.sample * (dim + 1) * doubled, dim, engine.rng)
        self._rounds += 1
        values = yield points
        engine.record.step("sample")
        minima, fun, _ = engine.record.minima.sorted()
        found = heads(np.vstack([points, minima]), np.append(values, fun), neighbours=self._neighbours)
        for row in found[found < len(points)]:
            yield from self._descend(engine, points[row], float(values[row]), radius=0.5 * self._wide(len(points), dim))

    def _descend(self, engine: Engine, start: Array, value: float, *, radius: float) -> Evaluations[End]:
        """Descend; where that was stuck as low as the best, as a start at a minimum is, it is a minimum too."""
        end = yield from engine.descend(start, value, radius=radius)
        if end.kind == "stuck" and end.fun <= engine.record.minima.best + self._margin(engine):
            engine.take_in(end)
        return end

    def _wide(self, number: int, dim: int) -> float:
        """Return how far so many points are from one another, no more than a descent trusts its first model."""
        return min(float(number ** (-1 / dim)), 2 * self._settings.radius)

    def _breed(self, engine: Engine) -> Evaluations[None]:
        """Descend from the promising offspring of the lowest minima."""
        minima, fun, _ = engine.record.minima.sorted()
        parents, _ = self._as_low_as_the_best(engine)
        if len(parents) < 2:
            parents = minima[: max(2, len(minima) // 2)]
        if len(parents) < 2:
            return
        apart = 0.5 * self._settings.same_point
        children = offspring(
            engine.rng.permutation(parents),
            np.vstack([minima, self._tried]),
            number=self._settings.children * (engine.record.dim + 1),
            apart=apart,
            rng=engine.rng,
            attempts=self._settings.breeding,
        )
        if not len(children):
            return
        values = yield children
        engine.record.step("breed")
        self._tried = np.vstack([self._tried, children])
        best = engine.record.best[1]
        promising = best + self._settings.promising * (float(np.median(fun)) - best) + self._margin(engine)
        for row in np.argsort(values, kind="stable"):
            if values[row] <= promising:
                yield from self._descend(
                    engine, children[row], float(values[row]), radius=5 * self._settings.same_point
                )

    def _hop(self, engine: Engine) -> Evaluations[None]:
        """Hop from the valley that was hopped from least, of those that do not end as low as the best."""
        if len(engine.record.minima) != self._sorted:
            self._find_valleys(engine)
        ceiling = engine.record.minima.best + self._margin(engine)
        open_ones = [valley for valley in self._valleys if valley.fun > ceiling]
        for valley in sorted(open_ones, key=lambda valley: (valley.hops, valley.fun))[: self._settings.children]:
            away = engine.rng.normal(size=engine.record.dim)
            start = np.clip(valley.u + valley.length * away / np.abs(away).max(), 0.0, 1.0)
            value = float((yield start[None])[0])
            end = yield from self._descend(engine, start, value, radius=self._settings.basin * valley.length)
            valley.hops += 1
            back = np.abs(end.u - valley.u).max() <= self._settings.same_point
            valley.length = float(np.clip(valley.length * (1.5 if back else 0.9), *self._settings.hops))
            if end.kind == "minimum" and end.fun < valley.fun and not back:
                valley.u, valley.fun, valley.hops = end.u, end.fun, 0

    def _find_valleys(self, engine: Engine) -> None:
        """List the minima that are the lowest of their surroundings, with what is known of the hops from there."""
        u, fun, _ = engine.record.minima.sorted()
        self._sorted = len(u)
        known = {valley.u.tobytes(): valley for valley in self._valleys}
        lowest = heads(u, fun, neighbours=self._neighbours) if len(u) > self._neighbours else np.arange(len(u))
        fresh = [_Valley(u[i], float(fun[i]), self._settings.radius) for i in lowest]
        self._valleys = [known.get(valley.u.tobytes(), valley) for valley in fresh]
