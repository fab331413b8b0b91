"""The farthest of the candidates, and what such points cover."""

import numpy as np
from scipy.spatial.distance import cdist

from rotorrig.identify.chea.steps.far_search import farthest


def test_the_candidate_with_the_most_distant_neighbour_wins() -> None:
    visited = np.array([[0.0, 0.0], [1.0, 1.0]])
    candidates = np.array([[0.1, 0.1], [0.0, 1.0], [0.5, 0.5]])  # nearest neighbours at 0.14, 1 and 0.71
    assert farthest(candidates, visited).tolist() == [0.0, 1.0]


def test_far_points_keep_their_distance_where_random_ones_crowd() -> None:
    rng = np.random.default_rng(0)
    far, plain = [np.array([0.5, 0.5])], rng.random((200, 2))
    while len(far) < 200:
        far.append(farthest(rng.random((5, 2)), np.array(far)))
    between = cdist(far, far) + 2 * np.eye(200)
    # 200 random points of a unit square are 0.5 / sqrt(200) = 0.035 from their nearest neighbour on average
    assert (cdist(plain, plain) + 2 * np.eye(200)).min(axis=1).mean() < 0.045
    assert between.min(axis=1).mean() > 0.045
