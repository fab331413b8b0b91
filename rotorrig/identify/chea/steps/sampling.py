"""Points that fill the unit cube evenly."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.steps.far_search import farthest
from rotorrig.identify.chea.steps.settings import STEPS

Array = NDArray[np.float64]


def spread(n: int, dim: int, rng: np.random.Generator) -> Array:
    """Return n points (n, dim) of the unit cube, farther from one another than random ones, turned at random.

    Additive recurrence with the roots of x^(dim + 1) = x + 1, the golden ratio for one dimension (Roberts, "The
    unreasonable effectiveness of quasirandom sequences", 2018), and a random shift (Cranley and Patterson, 1976). In
    two dimensions its points lie farther apart than Sobol's, and scipy.stats and its half second of import are saved.
    """
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (dim + 1))
    steps = np.outer(np.arange(1, n + 1), root ** -np.arange(1.0, dim + 1))
    return (rng.random(dim) + steps) % 1.0


def far_points(n: int, visited: Array, rng: np.random.Generator) -> Array:
    """Return n points (n, dim), each as far as may be from all `visited` ones (m, dim) and those before it.

    The efficient random search of the chapter, section 2.5, with more candidates than its five.
    """
    dim = visited.shape[1]
    candidates = rng.random((STEPS.candidates * (dim + 1), dim))
    chosen = np.empty((0, dim))
    for _ in range(n):
        chosen = np.vstack([chosen, farthest(candidates, np.vstack([visited, chosen]))])
    return chosen
