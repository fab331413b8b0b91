"""Calls of the objective: one by one, a batch at a time, or side by side in worker processes."""

import os
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.calls.call import Objective, Outcome, call
from rotorrig.identify.chea.calls.workers import Workers

Array = NDArray[np.float64]
Map = Callable[[Callable[[Array], Any], Iterable[Array]], Iterable[Any]]


class Evaluation:
    """Calls `fun`; a context manager, which owns the worker processes if there are any.

    A vectorised `fun` that raises fails for its whole batch: it should return NaN for the points it cannot do.
    """

    def __init__(self, fun: Objective, *, vectorized: bool = False, workers: int | Map = 1) -> None:
        """`workers` is as in `chea`.

        Raises ValueError if both kinds of parallel call are asked for, or a number of workers that is none; TypeError
        if `fun` cannot be sent to worker processes.
        """
        if vectorized and workers != 1:
            raise ValueError("workers and vectorized were both given, expected one of them: a batch is one call")
        if not callable(workers) and (not isinstance(workers, int) or (workers < 1 and workers != -1)):
            raise ValueError(f"workers is {workers!r}, expected a number of processes, -1 for every core, or a map")
        self._fun = fun
        self._vectorized = vectorized
        self._workers: Workers | None = None
        self._map: Callable[[Array], Iterable[Outcome]] = lambda x: map(partial(call, fun, n=1), x)
        if callable(workers):
            self._map = lambda x: workers(partial(call, fun, n=1), list(x))
        elif workers != 1:
            self._workers = Workers(fun, _cores() if workers == -1 else workers)
            self._map = self._workers.map

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *exc: object) -> None:
        """End the worker processes, also in the middle of a call."""
        if self._workers:
            self._workers.close()

    def __call__(self, x: Array) -> Iterator[Outcome]:
        """Yield what comes of points (n, dim), in order, as soon as it is there; the values add up to n.

        Raises TypeError if `fun` returns no number, ValueError if a map given as `workers` loses points.
        """
        if self._vectorized:
            yield call(self._fun, x, n=len(x))
            return
        known = 0
        for outcome in self._map(x):
            yield outcome
            known += 1
        if known != len(x):
            raise ValueError(f"the map given as workers returned {known} values, expected {len(x)}, one for each point")


def _cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
