"""Clusters of samples drawn by hand."""

import numpy as np

from rotorrig.identify.chea.steps.nearest_better_clustering import heads
from rotorrig.identify.chea.steps.sampling import spread


def test_each_of_two_valleys_has_one_head_the_lower_one_first() -> None:
    points = spread(200, 2, np.random.default_rng(0))
    left, right = (np.linalg.norm(points - centre, axis=1) for centre in ([0.2, 0.5], [0.8, 0.5]))
    found = heads(points, np.minimum(left, right - 0.1), neighbours=8)
    assert found.tolist() == [right.argmin(), left.argmin()]


def test_fewer_neighbours_only_add_heads() -> None:
    rng = np.random.default_rng(1)
    points, values = rng.random((100, 3)), rng.random(100)
    coarse, fine = (set(heads(points, values, neighbours=n)) for n in (8, 3))
    assert coarse < fine


def test_a_plateau_has_no_head() -> None:
    points = spread(50, 2, np.random.default_rng(0))
    assert len(heads(points, np.ones(50), neighbours=5)) == 0


def test_failed_points_head_nothing_and_hide_nobody() -> None:
    points = np.array([[0.0], [0.1], [0.2], [0.9]])
    assert heads(points, np.array([np.inf, 1.0, np.inf, np.inf]), neighbours=1).tolist() == [1]


def test_a_lone_point_heads_nothing() -> None:
    assert len(heads(np.zeros((1, 2)), np.zeros(1), neighbours=3)) == 0
