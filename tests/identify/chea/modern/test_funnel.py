"""Funnels whose bottom is known."""

import numpy as np
import pytest

from rotorrig.identify.chea.modern.funnel import fit_funnel

BOTTOM = np.array([0.62, 0.33, 0.5])


def points_and_distances(n: int) -> tuple[np.ndarray, np.ndarray]:
    points = np.random.default_rng(0).random((n, 3))
    return points, points - BOTTOM


def test_a_round_bowl_is_recognised_from_two_points_more_than_it_has_coefficients() -> None:
    points, away = points_and_distances(7)
    funnel = fit_funnel(points, 3.0 + 40 * (away**2).sum(axis=1))
    assert funnel is not None
    assert funnel.bottom == pytest.approx(BOTTOM, abs=1e-9)
    assert funnel.error < 1e-9
    assert fit_funnel(points[:6], 3.0 + 40 * (away[:6] ** 2).sum(axis=1)) is None


@pytest.mark.parametrize(
    "hessian",
    [np.diag([1.0, 20.0, 300.0]), np.array([[3.0, 2.0, 0.0], [2.0, 3.0, 1.0], [0.0, 1.0, 1.0]])],
    ids=["along the axes", "turned"],
)
def test_other_bowls_are_recognised_from_more_points(hessian: np.ndarray) -> None:
    points, away = points_and_distances(20)
    funnel = fit_funnel(points, np.einsum("ni,ij,nj->n", away, hessian, away))
    assert funnel is not None
    assert funnel.bottom == pytest.approx(BOTTOM, abs=1e-8)


def test_ripples_are_seen_through_and_told_as_an_error() -> None:
    points, away = points_and_distances(200)
    funnel = fit_funnel(points, 10 * (away**2).sum(axis=1) + np.cos(300 * points).sum(axis=1))
    assert funnel is not None
    assert funnel.bottom == pytest.approx(BOTTOM, abs=0.1)
    assert 0.4 < funnel.error < 0.9  # ripples of 1.2 rms, on a bowl of 1.5


def test_values_without_a_trend_are_foreseen_no_better_than_by_their_mean() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        funnel = fit_funnel(rng.random((30, 2)), rng.random(30))
        assert funnel is None or funnel.error > 0.8


def test_a_dome_is_no_funnel() -> None:
    points, away = points_and_distances(12)
    assert fit_funnel(points, -(away**2).sum(axis=1)) is None


def test_equal_values_and_points_in_one_place_are_no_funnels() -> None:
    points, away = points_and_distances(12)
    assert fit_funnel(points, np.ones(12)) is None
    assert fit_funnel(np.tile(points[:1], (12, 1)), away[:, 0]) is None


def test_a_bottom_outside_is_sought_on_the_bound() -> None:
    points = np.random.default_rng(0).random((20, 2))
    funnel = fit_funnel(points, ((points - [1.5, 0.4]) ** 2).sum(axis=1))
    assert funnel is not None
    assert funnel.bottom == pytest.approx([1.0, 0.4], abs=1e-9)
