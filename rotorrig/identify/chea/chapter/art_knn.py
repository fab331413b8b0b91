"""ART-Kohonen neural network: clusters without a number of clusters given beforehand (section 2.2)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]


def classify(points: Array, *, similarity: float) -> NDArray[np.intp]:
    """Return the cluster (n,), numbered from 0, of every point (n, dim) of the unit cube.

    Each point in turn wakes the nearest neuron. If the two are at least `similarity` alike they resonate and the neuron
    learns the point (its weights are the mean of what it learned); else the point becomes a new neuron. At the end
    every point joins the neuron nearest to it. The outcome depends on the order of the points.

    The chapter leaves the similarity law open. Here it is 1 - |v - b| / sqrt(dim): 1 for equal points, 0 for opposite
    corners of the cube. Unlike a law relative to |b|, it treats a cluster near the origin like any other.

    >>> classify(np.array([[0.1, 0.1], [0.9, 0.9], [0.1, 0.12]]), similarity=0.9).tolist()
    [0, 1, 0]
    """
    reach = (1.0 - similarity) * np.sqrt(points.shape[1])
    weights = np.empty_like(points)
    learned = np.zeros(len(points))
    count = 0
    for point, copies in zip(*_runs(points), strict=True):
        away = weights[:count] - point
        squares = np.einsum("ij,ij->i", away, away)
        winner = int(squares.argmin()) if count else 0
        if count == 0 or squares[winner] > reach**2:
            winner = count  # mismatch: the orienting subsystem resets, the novelty is stored as a new neuron
            weights[winner] = point
            count += 1
        learned[winner] += copies
        weights[winner] += (point - weights[winner]) * (copies / learned[winner])
    nearest = cdist(points, weights[:count]).argmin(axis=1)
    return np.unique(nearest, return_inverse=True)[1]  # a neuron that drifted off may have lost all its points


def _runs(points: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return the points without copies in a row, and how many of each there were: all of them wake the same neuron."""
    first = np.flatnonzero(np.append(True, (points[1:] != points[:-1]).any(axis=1)))
    return points[first], np.diff(first, append=len(points))
