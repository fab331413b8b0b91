"""How evenly points fill the cube."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from rotorrig.identify.chea.steps.sampling import far_points, spread


@pytest.mark.parametrize("dim", [1, 2, 5, 20])
def test_spread_points_lie_in_the_cube_and_half_of_them_in_each_half(dim: int) -> None:
    points = spread(64, dim, np.random.default_rng(0))
    assert points.shape == (64, dim)
    assert points.min() >= 0.0
    assert points.max() < 1.0
    # random points would be 4 off, and 12 in one of 20 parameters
    assert (np.abs((points < 0.5).sum(axis=0) - 32) <= 8).all()


def test_spread_points_keep_their_distance() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        apart = pdist(spread(48, 2, rng)).min()
        assert apart > 0.09  # 48 points on a square grid would have 0.144; random ones are 0.01 apart


def test_another_seed_gives_other_points() -> None:
    one, other = (spread(8, 2, np.random.default_rng(seed)) for seed in (1, 2))
    assert np.abs(one - other).min() > 0


def test_far_points_fill_the_empty_half_and_avoid_one_another() -> None:
    rng = np.random.default_rng(0)
    visited = rng.random((50, 2)) * [0.5, 1.0]
    points = far_points(2, visited, rng)
    assert (points[:, 0] > 0.8).all()
    assert np.linalg.norm(points[0] - points[1]) > 0.4
