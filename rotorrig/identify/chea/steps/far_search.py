"""The efficient random search of section 2.5: each new point as far as possible from all previous ones."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]


def farthest(candidates: Array, visited: Array) -> Array:
    """Return the candidate (dim,) whose nearest visited point is the most distant (steps 2 and 3).

    >>> farthest(np.array([[0.2], [0.6]]), np.array([[0.0], [1.0]])).tolist()
    [0.6]
    """
    return candidates[cdist(candidates, visited).min(axis=1).argmax()]
