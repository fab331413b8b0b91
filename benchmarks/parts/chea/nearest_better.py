"""NEA2, a published niching method beside ours: nearest-better clustering of a sample, and a CMA-ES for each cluster.

M. Preuss, "Improved topological niching for real-valued global optimization", EvoApplications 2012, LNCS 7248, 386: an
even sample of 40 points per parameter; every point is tied to the nearest better one; a tie is cut that is longer than
twice the mean, and where three or more ties end, one that is longer than b times the median of these; from the best
point of each piece a CMA-ES descends; then all begins anew, as far as the calls go. The CMA-ES is pycma's.
"""

import warnings
from math import log10

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from scipy.stats import qmc

from benchmarks.parts.chea.counting import BudgetSpent, Counted
from benchmarks.parts.chea.functions import Array
from benchmarks.parts.chea.peers import Found

PER_PARAMETER = 40  # points of a sample
LONG = 2.0  # times the mean tie: rule 1
FEWEST = 3  # ties that end at a point, for rule 2
SAME = 1e-3  # of the box: ends so close are one


def nea2(fun: Counted, bounds: Array, rng: np.random.Generator) -> Found:
    """Run NEA2 until the calls are used up; list the ends of all descents, each once."""
    low, width = bounds[:, 0], np.ptp(bounds, axis=1)
    dim = len(bounds)
    ends: list[tuple[float, Array]] = []
    try:
        while True:
            u = qmc.LatinHypercube(dim, rng=rng).random(PER_PARAMETER * dim)
            values = fun.batch(low + u * width)
            for start, reach in clusters(u, values):
                ends.append(_descend(fun, low, width, start, reach, int(rng.integers(1, 2**31))))
    except BudgetSpent:
        pass
    return Found(fun.best_x, low + _each_once(ends, (fun.best_x - low) / width) * width)


def clusters(points: Array, values: Array) -> list[tuple[Array, float]]:
    """Return the best point (dim,) of every piece, best first, and how far the next piece's is, at the most half.

    >>> points = np.array([[0.0], [0.1], [0.2], [0.8], [0.9], [1.0]])
    >>> [(float(u[0]), round(reach, 3)) for u, reach in clusters(points, np.array([2.0, 0.0, 1.0, 2.0, 0.5, 3.0]))]
    [(0.1, 0.4), (0.9, 0.4)]
    """
    n, dim = points.shape
    distance = cdist(points, points)
    better = values[None, :] < values[:, None]
    to_better = np.where(better, distance, np.inf)
    length, goal = to_better.min(axis=1), to_better.argmin(axis=1)
    tied = np.isfinite(length)
    cut = ~tied | (length > LONG * length[tied].mean())
    for i in np.flatnonzero(tied & ~cut):
        incoming = length[tied & (goal == i)]
        if len(incoming) >= FEWEST and length[i] > _factor(n, dim) * np.median(incoming):
            cut[i] = True
    heads = np.flatnonzero(cut)[np.argsort(values[cut], kind="stable")]
    apart = distance[np.ix_(heads, heads)] + np.diag(np.full(len(heads), np.inf))
    return [(points[i], min(0.5, float(apart[k].min()) / 2)) for k, i in enumerate(heads)]


def _factor(n: int, dim: int) -> float:
    """Return b of rule 2, fitted by Preuss to samples of n points in dim parameters."""
    of_size = -4.69e-4 * dim**2 + 0.0263 * dim + 3.66 / dim - 0.457
    return of_size * log10(n) + 7.51e-4 * dim**2 - 0.0421 * dim - 2.26 / dim + 1.83


def _descend(fun: Counted, low: Array, width: Array, start: Array, reach: float, seed: int) -> tuple[float, Array]:
    """Return the value and the place, in the unit cube, where a CMA-ES ends."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the import, about matplotlib; of flat ground
        import cma

        options = {"bounds": [0, 1], "seed": seed, "verbose": -9, "tolx": 1e-6, "tolfun": 1e-9}
        search = cma.CMAEvolutionStrategy(start, max(reach / 2, 1e-3), options)
        while not search.stop():
            asked = np.array(search.ask())
            search.tell(list(asked), fun.batch(low + asked * width).tolist())
        return float(search.result.fbest), np.array(search.result.xbest)


def _each_once(ends: list[tuple[float, Array]], best: Array) -> NDArray[np.float64]:
    """Return the places (n, dim) of descents, best first and each once, the best point met before them."""
    listed = [best]
    for _, u in sorted(ends, key=lambda end: end[0]):
        if np.abs(np.array(listed) - u).max(axis=1).min() > SAME:
            listed.append(u)
    return np.array(listed)
