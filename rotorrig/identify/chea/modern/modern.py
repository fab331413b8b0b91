"""`profile="modern"`: the chapter's plan, gather, cluster, search each cluster, look far away, with today's means.

Every part learns from the others: a point near a known minimum heads no cluster, a descent begins with the values known
around it and is given up when it makes for a known minimum, the minima show a funnel or a pattern to follow, and their
number and their ties say when to stop.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import Clusters, End, Engine, Method, nearest_better, next_head
from rotorrig.identify.chea.modern.funnel import fit_funnel
from rotorrig.identify.chea.modern.local_search import descend
from rotorrig.identify.chea.modern.more_minima import MoreMinima
from rotorrig.identify.chea.modern.natural_stop import Finds
from rotorrig.identify.chea.modern.recombination import offspring, spacing
from rotorrig.identify.chea.modern.settings import MODERN, ModernSettings
from rotorrig.identify.chea.session import Evaluations, Record
from rotorrig.identify.chea.steps import far_points, spread, sqp

__all__ = ["MODERN", "method"]

Array = NDArray[np.float64]


def method(dim: int, settings: ModernSettings) -> Method:
    """Gather and search, then breed and look far away until that leads nowhere new."""
    parts = _Parts(dim, settings)
    return Method(
        gather=parts.gather,
        local=parts.descend,
        after=parts.look_around,
        steps=(
            parts.search_clusters,
            parts.search_a_finer_cluster,
            parts.hop_on,
            parts.breed,
            parts.look_far,
            parts.polish,
        ),
        note=parts.finds.note,
        is_over=parts.finds.are_over,
        more=parts.more.search,
        has_all=parts.more.has_all,
    )


class _Parts:
    """The steps of a search, and what they remember of one another."""

    def __init__(self, dim: int, settings: ModernSettings) -> None:
        self.finds = Finds(dim, settings)
        self.more = MoreMinima(dim, settings, self.finds.margin)
        self._settings = settings
        self._neighbours = dim + settings.neighbours
        self._bottoms = np.empty((0, dim))  # of funnels, that were looked into
        self._confirmed = np.inf  # the lowest minimum that is one for certain
        self._hop_length = 0.5 * settings.radius

    def gather(self, engine: Engine, box: Array) -> Evaluations[Clusters]:
        """Evaluate an even sample of the box."""
        points = spread(self._settings.sample * (engine.record.dim + 1), engine.record.dim, engine.rng)
        yield from engine.gather(box[0] + (box[1] - box[0]) * points)
        engine.record.step("gather")
        return nearest_better(engine, neighbours=self._neighbours)

    def look_around(self, engine: Engine) -> Evaluations[None]:
        """Look for ripples finer than the sample after the first descent, and for funnels after all others."""
        yield from self._hop(engine) if engine.descents == 1 else self._follow_funnels(engine)

    def search_clusters(self, engine: Engine) -> Evaluations[None]:
        """Descend from the head of every cluster without a minimum."""
        yield from engine.search(nearest_better(engine, neighbours=self._neighbours))

    def search_a_finer_cluster(self, engine: Engine) -> Evaluations[None]:
        """After too few descents, search one more cluster, the coarsest there is when fewer neighbours are asked."""
        if self.finds.too_few(engine):
            rows = (next_head(engine, neighbours) for neighbours in range(self._neighbours, 0, -1))
            row = next((row for row in rows if row is not None), None)
            yield from engine.search(iter([] if row is None else [np.array([row])]))

    def hop_on(self, engine: Engine) -> Evaluations[None]:
        """Hop after too few descents, or where there are several minima."""
        if self.finds.too_few(engine) or len(engine.record.minima) > 1:
            yield from self._hop(engine)

    def _hop(self, engine: Engine) -> Evaluations[None]:
        """Descend from beside the lowest point; next time from farther if that led back, from nearer if elsewhere.

        Basin hopping (Wales and Doye 1997): in many dimensions a lower minimum is more often next to the best one than
        in a cluster of its own.
        """
        lowest, _ = engine.record.best
        away = engine.rng.normal(size=engine.record.dim)
        start = np.clip(lowest + self._hop_length * away / np.abs(away).max(), 0.0, 1.0)
        value = float((yield start[None])[0])
        end = yield from engine.descend(start, value, radius=self._settings.basin * self._hop_length, wary=False)
        back = np.abs(end.u - lowest).max() <= self._settings.same_point
        self._hop_length = float(np.clip(self._hop_length * (1.5 if back else 0.75), *self._settings.hops))
        yield from self._follow_funnels(engine)

    def _follow_funnels(self, engine: Engine) -> Evaluations[None]:
        """Descend from the bottoms of the trends of the gathered points and of the best minima, until they stay."""
        finite = np.isfinite(engine.values)
        for of_minima in (False, True):
            while len(engine.record.minima):
                minima, fun, _ = engine.record.minima.sorted()
                lowest = 2 * (engine.record.dim + 4)  # twice what a round funnel needs
                of = (minima[:lowest], fun[:lowest]) if of_minima else (engine.points[finite], engine.values[finite])
                funnel = fit_funnel(*of)
                if funnel is None or funnel.error > self._settings.funnel_error:
                    break
                moved = np.abs(np.vstack([minima, self._bottoms]) - funnel.bottom).max(axis=1).min()
                if moved <= min(self._settings.same_point, 0.1 * spacing(minima)):
                    break
                self._bottoms = np.vstack([self._bottoms, funnel.bottom])
                value = float((yield funnel.bottom[None])[0])
                yield from engine.descend(funnel.bottom, value, radius=self._settings.basin * self._apart(minima))

    def breed(self, engine: Engine) -> Evaluations[None]:
        """Evaluate the offspring of the minima; descend from what is promising, and as low as half of the minima."""
        minima, fun, _ = engine.record.minima.sorted()
        if len(minima) < 2:
            return
        apart = self._apart(minima)
        children = offspring(
            minima,
            engine.points,
            number=self._settings.children,
            apart=0.1 * apart,
            rng=engine.rng,
            attempts=self._settings.breeding,
        )
        rows = yield from engine.gather(children)
        engine.record.step("breed")
        for i in rows[np.argsort(engine.values[rows], kind="stable")]:
            best = engine.record.best[1]
            promising = best + self._settings.promising * (self.finds.usual(engine) - best)
            if engine.values[i] <= min(promising, float(np.median(fun))):
                yield from engine.descend_from(i, radius=self._settings.basin * apart)
                yield from self._follow_funnels(engine)

    def look_far(self, engine: Engine) -> Evaluations[None]:
        """Evaluate points far from all gathered; the clusters then show whether they lead anywhere."""
        yield from engine.gather(far_points(self._settings.far, engine.points, engine.rng))
        engine.record.step("far")

    def polish(self, engine: Engine) -> Evaluations[None]:
        """Descend from the lowest point by sequential quadratic programming, should that be no confirmed minimum.

        It takes the slope at one point, and so keeps its way along narrow valleys and kinks that no polynomial fits.
        """
        u, fun = engine.record.best
        if fun < self._confirmed:
            end, value = yield from sqp.descend(engine.record, u.copy(), fun)
            if not self._is_on_plateau(engine.record, end, value):
                engine.take_in(End(u=end, fun=value, kind="minimum"))
            self._confirmed = value
            engine.record.step("polish")

    def descend(
        self, record: Record, start: Array, value: float, *, radius: float | None, wary: bool
    ) -> Evaluations[End]:
        """Descend by the model; wary, it is given up when it makes for a known minimum.

        Any point of a plateau is an end: one that is not lower than all minima is none.
        """
        end = yield from descend(
            record,
            start,
            value,
            radius=self._settings.radius if radius is None else radius,
            stop_if=partial(self._makes_for_known, record) if wary else None,
            max_calls=self._settings.stint * (record.dim + 1),
            settings=self._settings.descent,
        )
        if end.kind == "minimum":
            self._confirmed = min(self._confirmed, end.fun)
        if end.kind in ("minimum", "stuck") and self._is_on_plateau(record, end.u, end.fun):
            return replace(end, kind="abandoned")
        return end

    def _makes_for_known(self, record: Record, u: Array, _fun: float, goal: Array, _foreseen: float) -> bool:
        """Return whether the `goal` of a descent now at `u` is a known minimum, and clearly which."""
        minima = record.minima.points
        if not len(minima):
            return False
        away = np.abs(minima - goal).max(axis=1)
        to_go = float(np.abs(minima[away.argmin()] - u).max())
        close = self._settings.heading * to_go + self._settings.same_point
        return bool(away.min() <= close and (away <= 4 * close).sum() == 1)

    def _is_on_plateau(self, record: Record, u: Array, fun: float) -> bool:
        """Return whether points not quite at `u`, which is no new lowest, have exactly its value."""
        if fun < record.minima.best:
            return False
        away = np.abs(record.points[record.values == fun] - u).max(axis=1)
        return bool(((away > 1e-2 * self._settings.same_point) & (away <= self._settings.same_point)).any())

    def _apart(self, minima: Array) -> float:
        """Return the usual distance of minima (n, dim), or what is expected of it."""
        return min(spacing(minima), 4 * self._settings.radius)
