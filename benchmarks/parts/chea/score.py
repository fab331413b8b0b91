"""One run of one method on one function, and what many of them come to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from benchmarks.parts.chea.counting import Counted
from benchmarks.parts.chea.functions import Array, Case, Problem
from benchmarks.parts.chea.peers import Method

ONE_PLACE = 0.01  # listed points this close, as a part of the box's half width, are one minimum


@dataclass(frozen=True, kw_only=True)
class Run:
    """What one run found. The method's own word counts for nothing but its points: values are taken here, uncounted."""

    calls: int
    fun: float  # at its best point
    offset: Array  # (dim,) of its best point from the nearest global minimum
    success: bool  # its best point is a global minimum, to the tolerance
    minima: int  # minima it lists, of those that are minima, each once
    found: float  # part of the global minima that is in its list


@dataclass(frozen=True, kw_only=True)
class Score:
    """What the runs of a method on a function come to."""

    calls: float  # mean
    calls_median: float
    calls_max: int
    fun: float  # mean
    x: list[float]  # mean, each as measured from its nearest global minimum; about the one next to the upper corner
    worst: float  # largest error of any parameter in any run
    success: float  # part of the runs
    minima: float  # mean
    all_globals: float  # part of the runs that list every global minimum
    share: float  # mean part of the global minima listed


def run(case: Case, method: Method, seed: int, *, budget: int | None) -> Run:
    """Run a method once, with the box and the generator of this seed."""
    problem = case.problem(seed)
    fun = Counted(problem.fun, budget=budget)
    found = method.run(fun, problem.bounds, np.random.default_rng(seed))
    nearest = problem.minima.nearest(found.listed)
    hit = (np.abs(nearest - found.listed) <= problem.tolerance).all(axis=1)
    offset = found.x - problem.minima.nearest(found.x[None])[0]
    return Run(
        calls=fun.calls,
        fun=float(problem.fun(found.x[None])[0]),
        offset=offset,
        success=bool((np.abs(offset) <= problem.tolerance).all()),
        minima=count_minima(problem, found.listed),
        found=len(np.unique(nearest[hit].round(6), axis=0)) / problem.minima.count,
    )


def summarise(runs: Sequence[Run], case: Case) -> Score:
    """Return the figures of many runs."""
    calls = [r.calls for r in runs]
    offsets = np.array([r.offset for r in runs])
    first = case.minima.nearest(case.bounds[:, 1][None])[0]
    return Score(
        calls=float(np.mean(calls)),
        calls_median=float(np.median(calls)),
        calls_max=max(calls),
        fun=float(np.mean([r.fun for r in runs])),
        x=(first + offsets.mean(axis=0)).tolist(),
        worst=float(np.abs(offsets).max()),
        success=float(np.mean([r.success for r in runs])),
        minima=float(np.mean([r.minima for r in runs])),
        all_globals=float(np.mean([r.found == 1.0 for r in runs])),
        share=float(np.mean([r.found for r in runs])),
    )


def count_minima(problem: Problem, listed: Array) -> int:
    """Return how many of the points (n, dim) are minima, each place counted once.

    A point counts if nothing on the sphere of the tolerance about it, as far as that lies in the box, is lower: then
    there is a minimum inside. Looked at in 256 directions, in two dimensions evenly; in more this is only a sample.
    """
    half = np.ptp(problem.bounds, axis=1) / 2
    x = np.clip(listed, *problem.bounds.T)
    x = x[np.argsort(problem.fun(x), kind="stable")]
    ring = np.clip(x[:, None] + directions(problem.dim) * problem.tolerance, *problem.bounds.T)
    around = problem.fun(ring.reshape(-1, problem.dim)).reshape(len(x), -1)
    x = x[(around >= problem.fun(x)[:, None]).all(axis=1)]
    near = cdist(x / half, x / half, "chebyshev") < ONE_PLACE
    return int((~np.tril(near, -1).any(axis=1)).sum())


def directions(dim: int) -> Array:
    """Return 256 unit vectors (256, dim)."""
    if dim == 2:
        angle = np.linspace(0, 2 * np.pi, 256, endpoint=False)
        return np.column_stack([np.cos(angle), np.sin(angle)])
    sample = np.random.default_rng(0).normal(size=(256, dim))
    return sample / np.linalg.norm(sample, axis=1, keepdims=True)
