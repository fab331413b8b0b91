"""`profile="seed"`: the parts of the flow chart of Fig. 1, as the chapter has them."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.chapter.clustering import Clustering, cluster
from rotorrig.identify.chea.chapter.genetic import Colony
from rotorrig.identify.chea.chapter.settings import SEED, SeedSettings
from rotorrig.identify.chea.engine import Clusters, End, Engine, Index, Method
from rotorrig.identify.chea.session import Evaluations, Record
from rotorrig.identify.chea.steps import descend, farthest

__all__ = ["SEED", "method"]

Array = NDArray[np.float64]


def method(dim: int, settings: SeedSettings) -> Method:
    """Reduce boxes until every cluster holds one minimum, then search far from all points (Fig. 1)."""
    parts = _Parts(settings)
    return Method(
        gather=parts.gather,
        local=parts.descend,
        members=settings.members,
        levels=settings.max_levels,
        steps=(parts.search_far,),
        is_over=lambda engine: engine.rounds == 1,
    )


class _Parts:
    def __init__(self, settings: SeedSettings) -> None:
        self._settings = settings

    def gather(self, engine: Engine, box: Array) -> Evaluations[Clusters]:
        """Breed until eq. (1) calls the clusters mature; add the population, best first, and return its clusters.

        The points of a cluster are distinct: a population near maturity is mostly copies, and local searches from
        copies of one point agree whatever the function.
        """
        colony = Colony(box, rng=engine.rng, settings=self._settings)
        yield from colony.create_founders()
        while True:
            engine.record.step("genetic")
            order = _finite_best_first(colony.fun)
            points, fun = colony.points[order], colony.fun[order]
            if not len(points):
                return iter(())
            clustering = cluster((points - box[0]) / (box[1] - box[0]), self._settings)
            if clustering.cef < self._settings.cef_stop or colony.generation == self._settings.max_generations:
                rows = engine.add(points, fun)
                return iter([rows[_without_copies(points, members)] for members in clustering.members()])
            yield from colony.advance(order[self._elites(clustering)])

    def _elites(self, clustering: Clustering) -> Index:
        """Return the best of all, and of each cluster that is no mere stray; individuals are best first.

        The chapter is silent on elitism. With the best of all alone a peak is lost by chance to another as high, and
        less is left to agree: eq. (3) takes 16 % more calls, eq. (4) 7 %.
        """
        firsts = [members[0] for members in clustering.members() if len(members) >= self._settings.min_cluster_size]
        return np.unique([0, *firsts])

    def descend(
        self, record: Record, start: Array, value: float, *, radius: float | None, wary: bool
    ) -> Evaluations[End]:
        """Descend by sequential quadratic programming; not all the way to a minimum that is known already.

        Followed to their ends, the searches on eqs. (2) to (4) take 3, 19 and 21 % more calls in all.
        """
        u, fun = yield from descend(record, start, value, near=self._settings.same_point if wary else 0.0)
        return End(u=u, fun=fun, kind="minimum" if np.isfinite(fun) else "no value")

    def search_far(self, engine: Engine) -> Evaluations[None]:
        """Section 2.5; after a local search the steps go on, to the maximum number of iterations."""
        for _ in range(self._settings.far_iterations):
            candidates = engine.rng.random((self._settings.far_candidates, engine.record.dim))
            point = farthest(candidates, engine.record.points)
            value = float((yield point[None])[0])
            if value < engine.record.minima.best:
                engine.record.tally("far")
                yield from engine.descend(point, value)
        engine.record.step("far")


def _finite_best_first(fun: Array) -> Index:
    order = np.argsort(fun, kind="stable")
    return order[np.isfinite(fun[order])]


def _without_copies(points: Array, members: Index) -> Index:
    """Return the members whose point is the first of its kind, in the order given (best first)."""
    first = np.unique(points[members], axis=0, return_index=True)[1]
    return members[np.sort(first)]
