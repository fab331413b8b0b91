"""Clusters of the gathered points by nearest-better clustering, worked out anew whenever the next is asked for."""

import numpy as np

from rotorrig.identify.chea.engine.engine import Clusters, Engine
from rotorrig.identify.chea.steps import heads


def nearest_better(engine: Engine, *, neighbours: int) -> Clusters:
    """Yield the best point of every cluster in which no descent began yet, the lowest first."""
    if not engine.started.any() and np.isfinite(engine.record.best[1]):
        yield np.array([engine.values.argmin()])  # heads a cluster even on a plateau
    while (row := next_head(engine, neighbours)) is not None:
        yield np.array([row])


def next_head(engine: Engine, neighbours: int) -> int | None:
    """Return the row of the best gathered point that heads a cluster, and where no descent began yet.

    The minima take part, so a point near a known minimum heads nothing.
    """
    minima, fun, _ = engine.record.minima.sorted()
    points, values = np.vstack([engine.points, minima]), np.append(engine.values, fun)
    for i in heads(points, values, neighbours=neighbours):
        if i < len(engine.points) and not engine.started[i]:
            return int(i)
    return None
