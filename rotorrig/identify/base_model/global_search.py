"""The global search of an identification: all places from where a refinement may begin, in a few hundred model calls.

The objectives on amplitudes are searched in the logarithmic shape of the response, the amount at its best: the
smoothest ground there is, on which the minima of f1, f2 and f3 lie near one another. Each minimum is then followed to
that of the objective itself.
"""

import time
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from rotorrig.identify.base_model.black_box import Outcome, SearchName, search_values, trace_search
from rotorrig.identify.base_model.objectives import Amplitudes, ComplexResidual, ObjectiveName
from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.base_model.steady_forward import Steady
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.identify.chea import RESIDUAL, ResidualResult, ResidualSettings, StopReason, residual_search
from rotorrig.identify.chea.residuals import SEARCH, Counted, descend_absolute, minimize_squares
from rotorrig.identify.chea.session import Minima
from rotorrig.identify.identification import Optimum, SearchTrace
from rotorrig.identify.measurement import Measurement
from rotorrig.processing import OrderTrackedResponse

Real = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchResult:
    """Result of a search."""

    optima: tuple[Optimum, ...]  # best first
    evaluations: int  # calls of the model, each the response and, where the search takes them, its derivatives
    stop: str
    trace: SearchTrace
    seconds: float


def search(
    response: OrderTrackedResponse,
    measured: Measurement,
    space: Space,
    *,
    objective: ObjectiveName = "residual",
    method: SearchName = "vector",
    seed: int = 0,
) -> SearchResult:
    """List the significant minima of an objective over the coefficients and the unbalance of `space`.

    "residual" is the whitened complex one and knows any space; "f1", "f2" and "f3" are the chapter's, of one unbalance.
    The method is told the "vector" of residuals and its derivatives, or the objective's value alone: CHEA's profiles
    "modern" and "seed", the latter the chapter's own.
    The model is the steady one; modulus and density stay at the nameplate's. Raises ValueError on another name,
    ConfigError and DataError where the space or the data do not suit an objective on amplitudes.
    """
    began = time.perf_counter()
    rng = np.random.default_rng(seed)
    with threadpool_limits(1, user_api="blas"):  # hundreds of small products: threads cost more than they save
        if objective == "residual":
            problem = ComplexResidual.of(response, measured, space)
            steady = problem.steady
            if method == "vector":
                found = search_residual(problem, rng=rng)
            else:
                found = search_values(problem.values, steady.dim, problem.theta, steady.values, method=method, rng=rng)
        else:
            amplitudes = Amplitudes.of(response, measured, space)
            if method == "vector":
                found = search_amplitudes(amplitudes, objective=objective, rng=rng)
            else:
                values = partial(amplitudes.values, objective=objective)
                found = search_values(
                    values, amplitudes.dim, amplitudes.theta, amplitudes.places, method=method, rng=rng
                )
    optima, calls, stop, trace = found
    seconds = time.perf_counter() - began
    return SearchResult(optima=optima, evaluations=calls, stop=str(stop), trace=trace, seconds=seconds)


def search_residual(
    problem: ComplexResidual, *, rng: np.random.Generator, settings: ResidualSettings = RESIDUAL
) -> Outcome:
    """Return the minima of the whitened residual's sum of squares, the calls of the model, and why the search ended."""
    steady = problem.steady
    floor = BASE_MODEL.rounding**2 * problem.size
    found = residual_search(problem, steady.dim, rng=rng, floor=floor, starts=steady.starts, settings=settings)
    optima = [Optimum(theta=problem.theta(u), cost=float(cost)) for u, cost in zip(found.u, found.cost, strict=True)]
    return tuple(optima), found.calls + len(optima), found.stop, _trace(found, steady)


def search_amplitudes(
    amplitudes: Amplitudes, *, objective: ObjectiveName, rng: np.random.Generator, settings: ResidualSettings = RESIDUAL
) -> Outcome:
    """Return the minima of f1, f2 or f3 likewise."""
    if objective not in ("f1", "f2", "f3"):
        raise ValueError(f"objective is {objective!r}, want 'residual', 'f1', 'f2' or 'f3'")
    steady = amplitudes.steady
    floor = amplitudes.figures * (BASE_MODEL.rounding / np.log(10.0)) ** 2
    found = residual_search(amplitudes.shape, steady.dim, rng=rng, floor=floor, starts=steady.starts, settings=settings)
    solved = found.stop is StopReason.TARGET
    minima, calls = Minima(amplitudes.dim, tolerance=settings.same_point), found.calls
    for u in found.u:
        v = np.append(u, amplitudes.amount(u))
        v, cost, more = _value(amplitudes, v, objective) if solved else _follow(amplitudes, v, objective)
        minima.add(v, cost)
        calls += 1 + more
    optima = [Optimum(theta=amplitudes.theta(v), cost=float(cost)) for v, cost, _ in zip(*minima.sorted(), strict=True)]
    return tuple(optima), calls, found.stop, _trace(found, steady)


def _trace(found: ResidualResult, steady: Steady) -> SearchTrace:
    """Return the way of a search by the vector of residuals, which solves for the amounts."""
    return trace_search("vector", found.stages, found.heads, found.points, steady.values)


def _value(amplitudes: Amplitudes, v: Real, objective: ObjectiveName) -> tuple[Real, float, int]:
    """Return `v`, the objective there and the one call that took."""
    r, _ = amplitudes.vector(objective)(v)
    return v, float(r @ r if objective == "f1" else np.abs(r).sum()), 1


def _follow(amplitudes: Amplitudes, v: Real, objective: ObjectiveName) -> tuple[Real, float, int]:
    """Return the minimum of the objective next to `v`, its value, and the calls that took."""
    fun = amplitudes.vector(objective)
    if objective != "f1":
        return descend_absolute(fun, v, radius=BASE_MODEL.first_step, max_calls=BASE_MODEL.descent)
    counted = Counted(fun)
    end = minimize_squares(
        counted,
        counted(v),
        bounds=(np.zeros(len(v)), np.ones(len(v))),
        settings=replace(SEARCH, reach=BASE_MODEL.first_step),
        share=BASE_MODEL.fine,
        max_steps=BASE_MODEL.descent,
        max_calls=BASE_MODEL.descent,
    )
    return end.point.p, end.point.cost, counted.calls
