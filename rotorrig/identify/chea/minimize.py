"""`chea`: global minimisation by the clustering-based hybrid evolutionary algorithm.

After the chapter "A Hybrid Evolutionary Algorithm and its Application to Parameter Identification of Rolling Elements
Bearings", sections 2 and 3; its source for the algorithm itself is Kim et al. (2006).
"""

import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult

from rotorrig.identify.chea.calls import Evaluation, Map, Objective
from rotorrig.identify.chea.profiles import Local, Profile
from rotorrig.identify.chea.search import Search
from rotorrig.identify.chea.session import Box, CheaResult, SearchState, Stop, StopReason

Callback = Callable[..., object]


def chea(
    fun: Objective,
    bounds: Box | None = None,
    *,
    rng: np.random.Generator | int | None = None,
    profile: Profile = "modern",
    settings: Any = None,
    local: Local | None = None,
    stop: Stop = "natural",
    x_scale: str | Sequence[str] = "linear",
    max_nfev: int = 10_000,
    f_target: float | None = None,
    vectorized: bool = False,
    workers: int | Map = 1,
    callback: Callback | None = None,
    resume: SearchState | None = None,
) -> CheaResult:
    """Minimise `fun` within `bounds`, and list the local minima met on the way.

    `fun` takes the parameters (dim,) and returns a number; with `vectorized` it takes (n, dim) and returns (n,). With
    `workers`, a number of processes, -1 for every core, or a function like `map`, it is called side by side. It is
    never called outside `bounds`, scipy's `Bounds` or (dim, 2), nor more than `max_nfev` times, finite differences
    included. A value that is not finite, or an exception, counts as a call and as +inf. `x_scale` is "linear" or "log",
    for all parameters or one by one: on a logarithmic scale the search, its distances and its tolerances are in
    decades. `local` descends by a "model" of all values near, or by "sqp" on finite differences; by default as the
    profile does. Given the same `rng`, a generator or a seed, the search is the same, however fun is called.

    The "natural" end is where nothing lower is to be expected. With `stop` "all" the search then goes on for further
    minima as low as the best, until it expects none; with "budget" it never ends by itself. Only profile "modern" can.

    The search ends by itself, at `f_target` (the best is at or below it), at the budget, on Ctrl-C, or when `callback`
    raises StopIteration. `callback(intermediate_result)` sees x, fun, nfev, nit, stage and state of the search after
    each batch that completed a step. A `state`, there or of the result, is plain data, may be pickled, and
    `chea(fun, resume=state)` goes on from there exactly as the search would have gone on: with the bounds, rng,
    profile, settings, local, stop and x_scale of its beginning, and `max_nfev` counted from there too. Calls that
    workers are at when a search is ended early are given up and not counted.

    Raises ValueError on unusable bounds, scale, profile, budget or state, TypeError when `fun` returns no number or
    cannot be sent to workers. An error of `callback` reaches the caller.

    >>> found = chea(lambda x: (x[0] - 3) ** 2 + (x[1] - 1) ** 2, [(-5, 5), (-5, 5)], rng=1)
    >>> found.x.round(4).tolist(), str(found.stop_reason)
    ([3.0, 1.0], 'converged')
    """
    if max_nfev < 1:
        raise ValueError(f"max_nfev is {max_nfev}, expected at least 1")
    if (bounds is None) == (resume is None):
        raise ValueError(f"bounds and resume were {'both' if resume else 'not'} given, expected one of them")
    with Evaluation(fun, vectorized=vectorized, workers=workers) as evaluation:
        if resume is not None:
            search = Search.resume(resume)
        else:
            assert bounds is not None
            search = Search(
                bounds, rng=rng, profile=profile, settings=settings, local=local, stop=stop, x_scale=x_scale
            )
        target = -np.inf if f_target is None else f_target
        try:
            reason = _run(search, evaluation, max_nfev=max_nfev, target=target, show=_shower(callback))
        except KeyboardInterrupt:
            search = Search.resume(search.state)  # wherever in its own code it was interrupted
            reason = StopReason.INTERRUPTED
    return search.result(reason)


def _run(
    search: Search, evaluation: Evaluation, *, max_nfev: int, target: float, show: Callable[[Search], object]
) -> StopReason | None:
    """Answer what the search asks, until something ends it; None: it ended by itself."""
    while not search.done:
        if search.record.best[1] <= target:
            return StopReason.TARGET
        allowed = search.ask()[: max(max_nfev - search.record.nfev, 0)]
        if not len(allowed):
            return StopReason.BUDGET
        steps = search.record.nit
        for values, failure in evaluation(allowed):
            search.tell(values, failure=failure)
            if search.record.best[1] <= target:
                break
        if search.record.nit > steps:
            try:
                show(search)
            except StopIteration:
                return StopReason.CALLBACK
    return None


def _shower(callback: Callback | None) -> Callable[[Search], object]:
    """Return what shows a search to `callback`, by keyword if it takes scipy's `intermediate_result`."""
    if callback is None:
        return lambda search: None
    try:
        by_keyword = "intermediate_result" in inspect.signature(callback).parameters
    except ValueError:  # some built-in functions have none
        by_keyword = False
    if by_keyword:
        return lambda search: callback(intermediate_result=_intermediate(search))
    return lambda search: callback(_intermediate(search))


def _intermediate(search: Search) -> OptimizeResult:
    record, state = search.record, search.state
    u, fun = record.best
    shown = OptimizeResult()
    shown.update(
        x=state.scaling.to_parameters(u),
        fun=fun,
        nfev=record.nfev,
        nit=record.nit,
        stage=record.stage,
        state=state,
    )
    return shown
