"""The chapter's experiment: the minima of an objective by its values alone, without derivatives."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.chea import RESIDUAL, StopReason, chea
from rotorrig.identify.chea import Stage as Calls
from rotorrig.identify.chea.session import Minima
from rotorrig.identify.identification import Optimum, SearchTrace, Stage

Real = NDArray[np.float64]
SearchName = Literal["vector", "modern", "seed"]
Theta = Callable[[Real], tuple[float, ...]]  # a point of the unit cube -> the unknowns in SI
Places = Callable[[Real], Real]  # points (n, dim) of the unit cube -> (n, unknown) SI, as far as they say
Outcome = tuple[tuple[Optimum, ...], int, StopReason, SearchTrace]  # the minima, the calls, why it ended, and its way


def search_values(
    values: Callable[[Real], Real],
    dim: int,
    theta: Theta,
    places: Places,
    *,
    method: Literal["modern", "seed"],
    rng: np.random.Generator,
) -> Outcome:
    """List the significant minima of `values`, points (n, dim) of the unit cube -> (n,), by a profile of CHEA."""
    points = []

    def watched(batch: Real) -> Real:
        points.append(batch)
        return values(batch)

    cube = [(0.0, 1.0)] * dim
    found = chea(watched, cube, rng=rng, profile=method, vectorized=True, max_nfev=BASE_MODEL.black_box)
    minima = Minima(dim, tolerance=RESIDUAL.same_point)
    for u, cost in zip([*found.xl, found.x], [*found.funl, found.fun], strict=True):
        if cost <= BASE_MODEL.significant * found.fun:
            minima.add(u, cost)
    optima = [Optimum(theta=theta(u), cost=float(cost)) for u, cost, _ in zip(*minima.sorted(), strict=True)]
    trace = trace_search(method, found.stages, found.heads, np.vstack(points), places, reduced=found.reduced)
    return tuple(optima), found.nfev, found.stop_reason, trace


def trace_search(
    method: SearchName, stages: Sequence[Calls], heads: Real, points: Real, places: Places, *, reduced: int = 0
) -> SearchTrace:
    """Return the way of a search with its places in SI; of many points an even choice."""
    shown = points[np.unique(np.linspace(0, len(points) - 1, BASE_MODEL.shown).astype(np.intp))]
    return SearchTrace(
        method=method,
        stages=tuple(Stage(name=done.name, steps=done.steps, evaluations=done.calls) for done in stages),
        reduced=reduced,
        heads=places(heads),
        points=places(shown),
    )
