"""Eq. (1) by hand, and the choice of the similarity with the least of it."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea import SEED
from rotorrig.identify.chea.chapter.clustering import cef, cluster


def test_cef_of_two_pairs_is_the_value_worked_out_by_hand() -> None:
    points = np.array([[0.0], [0.2], [0.8], [1.0]])
    # centres 0.1 and 0.9; each delta = 2 * 0.1^2 = 0.02, alpha = 0.5^0.9 = 0.53589, beta = 0.8^1.5 = 0.71554,
    # gamma = 0.2^0.9 = 0.23492: 0.02 * 0.23492 / (0.53589 * 0.71554) = 0.012253, the same for both
    assert cef(points, np.array([0, 0, 1, 1]), similarity=0.8, settings=SEED) == pytest.approx(0.012253, rel=1e-4)


def test_cef_of_a_lone_cluster_takes_the_diagonal_for_its_distance() -> None:
    points = np.array([[0.4, 0.5], [0.6, 0.5]])
    # delta 0.02, alpha 1, beta = sqrt(2)^1.5 = 1.68179, gamma = 0.5^0.9 = 0.53589
    assert cef(points, np.zeros(2, int), similarity=0.5, settings=SEED) == pytest.approx(0.02 * 0.53589 / 1.68179, 1e-4)


def test_tighter_groups_have_a_smaller_cef() -> None:
    rng = np.random.default_rng(1)
    labels = np.repeat([0, 1], 50)
    offsets = rng.normal(0, 1, (100, 2))
    centres = np.array([[0.25, 0.25], [0.75, 0.75]])[labels]
    loose, tight = (cef(centres + s * offsets, labels, similarity=0.8, settings=SEED) for s in (0.05, 0.02))
    assert tight == pytest.approx(loose * (0.02 / 0.05) ** 2, rel=0.05)  # delta is quadratic, the centres hardly move


def test_four_tight_groups_are_mature_and_found() -> None:
    rng = np.random.default_rng(2)
    truth = rng.integers(0, 4, 200)
    points = np.array([[0.3, 0.3], [0.7, 0.3], [0.3, 0.7], [0.7, 0.7]])[truth] + rng.normal(0, 0.02, (200, 2))
    found = cluster(points, SEED)
    assert found.cef < SEED.cef_stop
    assert {len(set(truth[members])) for members in found.members()} == {1}
    assert len(found.members()) == 4


@pytest.mark.parametrize("dim", [1, 2, 5, 8])
def test_a_scattered_population_is_not_mature(dim: int) -> None:
    for seed in range(10):
        points = np.random.default_rng(seed).random((200, dim))
        assert cluster(points, SEED).cef > SEED.cef_stop


def test_a_population_scattered_in_five_dimensions_would_pass_for_mature_without_the_least_size() -> None:
    points = np.random.default_rng(1).random((200, 5))
    assert cluster(points, replace(SEED, min_cluster_size=0.0)).cef < SEED.cef_stop


def test_members_partition_the_points() -> None:
    points = np.random.default_rng(4).random((50, 2))
    members = np.concatenate(cluster(points, SEED).members())
    assert sorted(members) == list(range(50))


def test_one_point_is_one_cluster() -> None:
    assert cluster(np.array([[0.5, 0.5]]), SEED).labels.tolist() == [0]
