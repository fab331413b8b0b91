"""Recombination of minima: where further minima should be, if those known are part of a pattern.

Two ways, half of the offspring each. Crossover takes every parameter from one of two minima, and is right where the
parameters act separately. The parallelogram a + b - c (the difference of differential evolution, Storn and Price 1997)
is right where minima form a lattice, however it lies; with few minima, it is the neighbour of one at the distance of
two others.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from rotorrig.identify.chea.modern.settings import MODERN

Array = NDArray[np.float64]


def offspring(
    minima: Array,
    known: Array,
    *,
    number: int,
    apart: float,
    rng: np.random.Generator,
    attempts: int = MODERN.breeding,
) -> Array:
    """Return up to `number` points (m, dim) of the unit cube bred from `minima` (n, dim), which are sorted best first.

    So many `attempts` are made per child, and those of the best parents taken. No child is within `apart` of a minimum,
    a `known` point (k, dim) or another child, in every parameter.
    """
    parents = rng.integers(0, len(minima), (attempts * number, 3))
    a, b, c = (minima[parents[:, i]] for i in range(3))
    crossed = rng.random(len(parents)) < 0.5
    bred = np.where(crossed[:, None], np.where(rng.random(a.shape) < 0.5, a, b), a + b - c)
    parents[crossed, 2] = parents[crossed, :2].mean(axis=1)
    children, taken = np.empty((0, minima.shape[1])), np.vstack([minima, known])
    for child in bred[parents.sum(axis=1).argsort(kind="stable")]:
        if child.min() >= 0 and child.max() <= 1 and np.abs(taken - child).max(axis=1).min() > apart:
            children, taken = np.vstack([children, child]), np.vstack([taken, child])
            if len(children) == number:
                break
    return children


def spacing(minima: Array) -> float:
    """Return the usual distance from one of minima (n, dim) to the nearest other; +inf for a single one."""
    if len(minima) < 2:
        return np.inf
    distance = cdist(minima, minima)
    np.fill_diagonal(distance, np.inf)
    return float(np.median(distance.min(axis=1)))
