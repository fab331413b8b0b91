"""Clusters of a population, and how mature they are: the clustering evaluation function, eq. (1)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from rotorrig.identify.chea.chapter.art_knn import classify
from rotorrig.identify.chea.chapter.settings import SeedSettings

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Clustering:
    """One classification of a population, and its CEF (small: well gathered, well apart)."""

    labels: NDArray[np.intp]  # (n,) cluster of every point, numbered from 0
    similarity: float
    cef: float

    def members(self) -> list[NDArray[np.intp]]:
        """Return the indices of the points of each cluster."""
        return [np.flatnonzero(self.labels == j) for j in range(self.labels.max() + 1)]


def cluster(points: Array, settings: SeedSettings) -> Clustering:
    """Return the clustering of points (n, dim) of the unit cube that has the least CEF (section 2.3, steps 2 and 3).

    Clusterings with fewer than `min_cluster_size` points per cluster on average are left out: eq. (1) gives a cluster
    of one a spread of zero, so 200 points scattered over five dimensions, hardly any two alike, would count as mature
    before the first generation. The least similarity always remains as a choice.
    """
    clusterings: list[Clustering] = []
    for similarity in settings.similarities:
        labels = classify(points, similarity=similarity)
        if clusterings and (labels.max() + 1) * settings.min_cluster_size > len(points):
            break  # a higher similarity splits further
        value = cef(points, labels, similarity=similarity, settings=settings)
        clusterings.append(Clustering(labels=labels, similarity=similarity, cef=value))
    return min(clusterings, key=lambda clustering: clustering.cef)


def cef(points: Array, labels: NDArray[np.intp], *, similarity: float, settings: SeedSettings) -> float:
    """Return eq. (1) of points (n, dim) classified as `labels` (n,).

    The spread delta_j is the sum of squares, as printed, where the text speaks of an average. A lone cluster has no
    neighbour to be distant from: its distance is taken as the largest there is, the diagonal of the cube. With 1,
    the edge, Rastrigin's function takes 5 % fewer calls, the others as many, and as many runs succeed.
    """
    sizes = np.bincount(labels)
    centres = np.array([points[labels == j].mean(axis=0) for j in range(len(sizes))])
    delta = np.bincount(labels, weights=((points - centres[labels]) ** 2).sum(axis=1))
    alpha = (sizes / sizes.sum()) ** settings.weight_size
    beta = _nearest_centre(centres) ** settings.weight_distance
    gamma = (1.0 - similarity) ** settings.weight_similarity
    return float(np.mean(delta * gamma / (alpha * beta)))  # eq. (1)


def _nearest_centre(centres: Array) -> Array:
    """Return the distance (M,) from each centre (M, dim) to the nearest other one."""
    if len(centres) == 1:
        return np.full(1, np.sqrt(centres.shape[1]))
    distances = cdist(centres, centres)
    np.fill_diagonal(distances, np.inf)
    return np.maximum(distances.min(axis=1), np.finfo(float).tiny)
