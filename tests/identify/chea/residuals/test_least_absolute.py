"""Sums of absolute residuals whose minima are known by hand."""

import numpy as np
import pytest

from rotorrig.identify.chea.residuals.least_absolute import descend_absolute


def test_a_constant_fitted_to_numbers_is_their_median():
    numbers = np.array([0.1, 0.2, 0.35, 0.8, 0.9])
    u, value, _ = descend_absolute(lambda u: (u[0] - numbers, np.ones((5, 1))), np.array([0.7]), radius=0.1)
    assert u[0] == pytest.approx(0.35)
    assert value == pytest.approx(0.25 + 0.15 + 0.45 + 0.55)


def test_outliers_do_not_move_a_curve_that_most_points_lie_on(rng):
    x = np.linspace(0, 1, 40)
    y = np.exp(-3 * 0.4 * x) + 0.2
    y[::5] += rng.uniform(0.5, 2, 8)

    def fun(u):
        curve = np.exp(-3 * u[0] * x)
        return curve + u[1] - y, np.column_stack([-3 * x * curve, np.ones(40)])

    u, value, calls = descend_absolute(fun, np.array([0.9, 0.9]), radius=0.05)
    assert u == pytest.approx([0.4, 0.2], abs=1e-9)
    assert value == pytest.approx((y - np.exp(-1.2 * x) - 0.2).sum())
    assert calls < 25


def test_a_minimum_outside_the_cube_is_sought_on_its_face():
    u, value, _ = descend_absolute(lambda u: (u - np.array([1.5, 0.4]), np.eye(2)), np.array([0.1, 0.1]), radius=0.3)
    assert u.tolist() == pytest.approx([1.0, 0.4])
    assert value == pytest.approx(0.5)


def test_it_keeps_to_its_calls_and_stays_inside():
    visited = []

    def fun(u):
        visited.append(u)
        x, y = 4 * u - 2
        return np.array([10 * (y - x**2), 1 - x]), 4 * np.array([[-20 * x, 10.0], [-1.0, 0.0]])

    _, _, calls = descend_absolute(fun, np.array([0.02, 0.98]), radius=0.02, max_calls=9)
    assert calls == len(visited) == 9
    assert min(u.min() for u in visited) >= 0.0
    assert max(u.max() for u in visited) <= 1.0


def test_where_there_is_no_answer_it_does_not_go():
    def cliff(u):
        return (u - 0.9 if u[0] < 0.7 else u * np.nan), np.ones((1, 1))

    u, value, _ = descend_absolute(cliff, np.array([0.5]), radius=0.5)
    assert u[0] < 0.7
    assert np.isfinite(value)
