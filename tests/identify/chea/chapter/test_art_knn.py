"""ART-Kohonen classification of points placed by hand."""

import numpy as np
import pytest

from rotorrig.identify.chea.chapter.art_knn import classify

CORNERS = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9], [0.9, 0.9]])


def around_corners(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    truth = rng.integers(0, 4, 80)
    truth[:4] = range(4)
    return CORNERS[truth] + rng.uniform(-0.05, 0.05, (80, 2)), truth


def test_four_groups_in_the_corners_are_four_clusters() -> None:
    points, truth = around_corners(np.random.default_rng(0))
    assert classify(points, similarity=0.8).tolist() == truth.tolist()  # the first four points come in corner order


def test_low_similarity_takes_everything_for_one_cluster() -> None:
    points, _ = around_corners(np.random.default_rng(0))
    assert set(classify(points, similarity=0.1)) == {0}


def test_similarity_one_tells_all_distinct_points_apart() -> None:
    points, _ = around_corners(np.random.default_rng(0))
    assert classify(points, similarity=1.0).tolist() == list(range(80))


@pytest.mark.parametrize("shift", [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5]])
def test_moving_all_points_changes_no_cluster(shift: list[float]) -> None:
    points = np.random.default_rng(3).uniform(0, 0.5, (60, 2)).round(6)
    moved = classify(points + np.array(shift), similarity=0.85)
    assert moved.tolist() == classify(points, similarity=0.85).tolist()


def test_labels_leave_no_number_out() -> None:
    points = np.random.default_rng(5).random((200, 3))
    for similarity in (0.5, 0.7, 0.9):
        labels = classify(points, similarity=similarity)
        assert set(labels) == set(range(labels.max() + 1))


def test_threshold_is_the_stated_share_of_the_diagonal() -> None:
    apart = np.array([[0.0, 0.0], [0.14, 0.0]])  # 0.14 = 0.099 of the diagonal 1.414
    assert classify(apart, similarity=0.90).tolist() == [0, 0]
    assert classify(apart, similarity=0.91).tolist() == [0, 1]


def test_copies_in_a_row_weigh_as_much_as_each_by_itself() -> None:
    points = np.array([[0.0], [0.0], [0.0], [0.3], [0.52]])
    # The mean of the neuron is 0.3 / 4 = 0.075 after four points, 0.445 from the last, which becomes a neuron: at the
    # end the one nearer to 0.3. Were the copies learned as one point, the mean would be 0.15, within 0.4 of the last.
    assert classify(points, similarity=0.6).tolist() == [0, 0, 0, 1, 1]
