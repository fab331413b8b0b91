"""`profile="modern"`: the chapter's plan, gather, cluster, search each cluster, look far away, with today's means.

Every part learns from the others: a point near a known minimum heads no cluster, a descent begins with the values known
around it and is given up when it makes for a known minimum, the minima show a funnel or a pattern to follow, and their
number and their ties say when to stop.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.modern.funnel import fit_funnel
from rotorrig.identify.chea.modern.local_search import descend
from rotorrig.identify.chea.modern.natural_stop import NaturalStop
from rotorrig.identify.chea.modern.recombination import offspring, spacing
from rotorrig.identify.chea.modern.settings import MODERN, ModernSettings
from rotorrig.identify.chea.session import Evaluations, Record, StopReason
from rotorrig.identify.chea.steps import far_points, heads, spread, sqp

__all__ = ["MODERN", "search"]

Array = NDArray[np.float64]


def search(record: Record, rng: np.random.Generator, settings: ModernSettings) -> Evaluations[StopReason]:
    """Gather and search, then breed and look far away until that leads nowhere new."""
    return (yield from _Plan(record, rng, settings).run())


class _Plan:
    """The points gathered, what was done about them, and the steps that add to both."""

    def __init__(self, record: Record, rng: np.random.Generator, settings: ModernSettings) -> None:
        self._record = record
        self._rng = rng
        self._settings = settings
        self._points = np.empty((0, record.dim))  # those of the sample, bred or far away: not those of descents
        self._values = np.empty(0)
        self._started = np.empty(0, dtype=np.bool_)  # whether a descent began there
        self._bottoms = np.empty((0, record.dim))  # of funnels, that were looked into
        self._confirmed = np.inf  # the lowest minimum that is one for certain
        self._hop_length = 0.5 * settings.radius
        self._stop = NaturalStop(
            patience=settings.patience,
            idle=settings.idle * (record.dim + 1),
            per_minimum=settings.per_minimum,
            most=settings.descents + settings.descents_per_parameter * record.dim,
            agreeing=settings.agreeing,
            shared=settings.shared,
        )

    def run(self) -> Evaluations[StopReason]:
        dim = self._record.dim
        yield from self._gather(spread(self._settings.sample * (dim + 1), dim, self._rng))
        self._record.step("gather")
        if not np.isfinite(self._record.best[1]):
            return StopReason.NO_FINITE_VALUE
        self._usual = float(np.median(self._values[np.isfinite(self._values)]))
        yield from self._descend_from(int(self._values.argmin()))
        yield from self._hop()  # shows ripples finer than the sample
        while True:
            yield from self._search_clusters()
            if self._too_few_descents():
                yield from self._search_a_finer_cluster()
            if self._too_few_descents() or len(self._record.minima) > 1:
                yield from self._hop()
            yield from self._breed()
            yield from self._look_far()
            yield from self._polish()
            if self._stop.is_reached(len(self._record.minima), self._record.nfev):
                return StopReason.CONVERGED

    def _too_few_descents(self) -> bool:
        return self._stop.too_few(len(self._record.minima))

    def _gather(self, points: Array) -> Evaluations[NDArray[np.intp]]:
        """Evaluate points (n, dim); return the rows (n,) they have among all gathered."""
        values = yield points
        self._points = np.vstack([self._points, points])
        self._values = np.append(self._values, values)
        self._started = np.append(self._started, np.zeros(len(points), dtype=np.bool_))
        return np.arange(len(self._values) - len(values), len(self._values))

    def _search_clusters(self) -> Evaluations[None]:
        """Descend from the head of every cluster without a minimum, and into the funnels that shows."""
        while (start := self._next_head(self._record.dim + self._settings.neighbours)) is not None:
            yield from self._descend_from(start)
            yield from self._follow_funnels()

    def _search_a_finer_cluster(self) -> Evaluations[None]:
        """Descend from the head of one more cluster, the coarsest there is when fewer neighbours are asked."""
        for neighbours in range(self._record.dim + self._settings.neighbours, 0, -1):
            if (start := self._next_head(neighbours)) is not None:
                yield from self._descend_from(start)
                yield from self._follow_funnels()
                return

    def _next_head(self, neighbours: int) -> int | None:
        """Return the row of the best gathered point that heads a cluster, and where no descent began yet.

        The minima take part, so a point near a known minimum heads nothing.
        """
        minima, fun, _ = self._record.minima.sorted()
        points, values = np.vstack([self._points, minima]), np.append(self._values, fun)
        for i in heads(points, values, neighbours=neighbours):
            if i < len(self._points) and not self._started[i]:
                return int(i)
        return None

    def _hop(self) -> Evaluations[None]:
        """Descend from beside the lowest point; next time from farther if that led back, from nearer if elsewhere.

        Basin hopping (Wales and Doye 1997): in many dimensions a lower minimum is more often next to the best one than
        in a cluster of its own.
        """
        lowest, _ = self._record.best
        away = self._rng.normal(size=self._record.dim)
        start = np.clip(lowest + self._hop_length * away / np.abs(away).max(), 0.0, 1.0)
        value = float((yield start[None])[0])
        end = yield from self._descend(start, value, radius=self._settings.basin * self._hop_length, wary=False)
        back = np.abs(end - lowest).max() <= self._settings.same_point
        self._hop_length = float(np.clip(self._hop_length * (1.5 if back else 0.75), *self._settings.hops))
        yield from self._follow_funnels()

    def _follow_funnels(self) -> Evaluations[None]:
        """Descend from the bottoms of the trends of the gathered points and of the best minima, until they stay."""
        finite = np.isfinite(self._values)
        for of_minima in (False, True):
            while len(self._record.minima):
                minima, fun, _ = self._record.minima.sorted()
                lowest = 2 * (self._record.dim + 4)  # twice what a round funnel needs
                of = (minima[:lowest], fun[:lowest]) if of_minima else (self._points[finite], self._values[finite])
                funnel = fit_funnel(*of)
                if funnel is None or funnel.error > self._settings.funnel_error:
                    break
                moved = np.abs(np.vstack([minima, self._bottoms]) - funnel.bottom).max(axis=1).min()
                if moved <= min(self._settings.same_point, 0.1 * spacing(minima)):
                    break
                self._bottoms = np.vstack([self._bottoms, funnel.bottom])
                value = float((yield funnel.bottom[None])[0])
                yield from self._descend(funnel.bottom, value, radius=self._settings.basin * self._apart(minima))

    def _breed(self) -> Evaluations[None]:
        """Evaluate the offspring of the minima; descend from what is promising, and as low as half of the minima."""
        minima, fun, _ = self._record.minima.sorted()
        if len(minima) < 2:
            return
        apart = self._apart(minima)
        children = offspring(
            minima,
            self._points,
            number=self._settings.children,
            apart=0.1 * apart,
            rng=self._rng,
            attempts=self._settings.breeding,
        )
        rows = yield from self._gather(children)
        self._record.step("breed")
        for i in rows[np.argsort(self._values[rows], kind="stable")]:
            best = self._record.best[1]
            promising = best + self._settings.promising * (self._usual - best)
            if self._values[i] <= min(promising, float(np.median(fun))):
                yield from self._descend_from(i, radius=self._settings.basin * apart)
                yield from self._follow_funnels()

    def _look_far(self) -> Evaluations[None]:
        """Evaluate points far from all gathered; the clusters then show whether they lead anywhere."""
        yield from self._gather(far_points(self._settings.far, self._points, self._rng))
        self._record.step("far")

    def _polish(self) -> Evaluations[None]:
        """Descend from the lowest point by sequential quadratic programming, should that be no confirmed minimum.

        It takes the slope at one point, and so keeps its way along narrow valleys and kinks that no polynomial fits.
        """
        u, fun = self._record.best
        if fun < self._confirmed:
            end, value = yield from sqp.descend(self._record, u.copy(), fun)
            self._take_in(end, value)
            self._confirmed = value
            self._record.step("polish")

    def _descend_from(self, row: int, *, radius: float | None = None) -> Evaluations[None]:
        self._started[row] = True
        radius = self._settings.radius if radius is None else radius
        yield from self._descend(self._points[row], float(self._values[row]), radius=radius)

    def _descend(self, start: Array, value: float, *, radius: float, wary: bool = True) -> Evaluations[Array]:
        """Return the end (dim,) of a descent; wary, it is given up when it makes for a known minimum."""
        stop_if = self._makes_for_known if wary else None
        limit = self._settings.stint * (self._record.dim + 1)
        end = yield from descend(
            self._record,
            start,
            value,
            radius=radius,
            stop_if=stop_if,
            max_calls=limit,
            settings=self._settings.descent,
        )
        if end.kind == "minimum" or (end.kind == "stuck" and end.fun <= self._record.best[1]):
            self._take_in(end.u, end.fun)
        if end.kind == "minimum":
            self._confirmed = min(self._confirmed, end.fun)
        self._stop.descents += 1
        self._record.step("local")
        return end.u

    def _take_in(self, u: Array, fun: float) -> None:
        """Add the end of a descent to the minima; a lower value elsewhere, or one as low, is a find.

        Of plateaus, of which any point is an end, only one lower than all minima is taken in.
        """
        minima = self._record.minima
        if fun >= minima.best and self._is_flat(u, fun):
            return
        before, fun_before, _ = minima.sorted()
        minima.add(u, fun)
        after, values, _ = minima.sorted()
        margin = self._settings.tie * (self._usual - minima.best)
        lower = not len(before) or (
            minima.best < fun_before[0] - margin and np.abs(after[0] - before[0]).max() > self._settings.same_point
        )
        self._stop.note_minimum(
            lower=bool(lower), ties=int((values <= minima.best + margin).sum()), nfev=self._record.nfev
        )

    def _is_flat(self, u: Array, fun: float) -> bool:
        """Return whether points not quite at `u` have exactly its value."""
        away = np.abs(self._record.points[self._record.values == fun] - u).max(axis=1)
        return bool(((away > 1e-2 * self._settings.same_point) & (away <= self._settings.same_point)).any())

    def _makes_for_known(self, u: Array, _fun: float, goal: Array, _foreseen: float) -> bool:
        """Return whether the `goal` of a descent now at `u` is a known minimum, and clearly which."""
        minima, _, _ = self._record.minima.sorted()
        if not len(minima):
            return False
        away = np.abs(minima - goal).max(axis=1)
        to_go = float(np.abs(minima[away.argmin()] - u).max())
        close = self._settings.heading * to_go + self._settings.same_point
        return bool(away.min() <= close and (away <= 4 * close).sum() == 1)

    def _apart(self, minima: Array) -> float:
        """Return the usual distance of minima (n, dim), or what is expected of it."""
        return min(spacing(minima), 4 * self._settings.radius)
