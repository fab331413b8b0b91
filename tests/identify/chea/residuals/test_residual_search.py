"""The search for least squares finds what is there, all of it, and ends by itself."""

import numpy as np
import pytest

from rotorrig.identify.chea import ABSOLUTES, StopReason, residual_search


def peak(level=0.0):
    """Return the residuals of a resonance curve's logarithm: place, width and height sought; `level` cannot be met."""
    omega = np.linspace(0.05, 1.0, 60)

    def curve(u):
        return 1 / ((u[0] - omega) ** 2 + (0.005 + 0.1 * u[1]) ** 2)

    truth = np.array([0.63, 0.2, 0.4])

    def fun(u):
        c = curve(u)
        width = 0.005 + 0.1 * u[1]
        by = np.column_stack([-2 * (u[0] - omega) * c, -0.2 * width * c, np.full(60, 3.0)])
        r = np.log(c) + 3 * u[2] - np.log(curve(truth)) - 3 * truth[2]
        return np.append(r, level), np.vstack([by, np.zeros(3)])

    return fun, truth


def two_bottoms(level):
    """Return residuals with minima at 1/4 and 3/4 of the first parameter, `level` above zero."""

    def fun(u):
        x = 4 * u[0] - 2
        return np.array([x**2 - 1, u[1] - 0.3, level]), np.array([[8 * x, 0.0], [0.0, 1.0], [0.0, 0.0]])

    return fun


@pytest.mark.parametrize("seed", range(10))
def test_a_residual_that_vanishes_ends_the_search(seed):
    fun, truth = peak()
    found = residual_search(fun, 3, rng=np.random.default_rng(seed), floor=1e-16)
    assert found.stop is StopReason.TARGET
    assert found.u[0] == pytest.approx(truth, abs=1e-6)
    assert found.calls < 120


def test_with_a_rest_that_cannot_vanish_it_ends_when_it_keeps_coming_back(rng):
    fun, truth = peak(level=0.5)
    found = residual_search(fun, 3, rng=rng, floor=1e-16)
    assert found.stop is StopReason.CONVERGED
    assert found.u[0] == pytest.approx(truth, abs=1e-6)
    assert found.cost[0] == pytest.approx(0.25)
    assert found.hits[0] >= 9  # W (W + 1) / (N (N - 1)) <= 0.03


def test_all_significant_minima_are_listed(rng):
    found = residual_search(two_bottoms(0.1), 2, rng=rng)
    assert np.sort(found.u[:, 0]) == pytest.approx([0.25, 0.75], abs=1e-5)
    assert found.cost == pytest.approx([0.01, 0.01])


def test_a_minimum_that_explains_nothing_is_not_listed(rng):
    def fun(u):
        """A quartic with a low bottom on the left and one a hundred times as high on the right."""
        x = 4 * u[0] - 2
        return np.array([x**2 - 1, 0.5 * (x + 1), 0.1]), np.array([[8 * x], [2.0], [0.0]])

    found = residual_search(fun, 1, rng=rng)
    assert found.u[:, 0] == pytest.approx([0.25], abs=1e-5)


def test_a_parameter_that_changes_nothing_makes_one_minimum_and_not_many(rng):
    found = residual_search(lambda u: (np.array([u[0] - 0.4, 0.1]), np.array([[1.0, 0.0], [0.0, 0.0]])), 2, rng=rng)
    assert found.stop is StopReason.CONVERGED
    assert len(found.u) == 1


def test_constant_residuals_end_it_at_once(rng):
    found = residual_search(lambda u: (np.ones(3), np.zeros((3, 2))), 2, rng=rng)
    assert found.stop is StopReason.CONVERGED
    assert found.calls < 40


@pytest.mark.parametrize("budget", [1, 3, 10, 30])
def test_the_budget_is_kept_and_the_lowest_point_returned(rng, budget):
    costs = []

    def counted(u):
        r, J = two_bottoms(0.1)(u)
        costs.append(r @ r)
        return r, J

    found = residual_search(counted, 2, rng=rng, max_calls=budget)
    assert found.calls == len(costs) <= budget
    assert found.stop is StopReason.BUDGET
    assert found.cost[0] == pytest.approx(min(costs))


def test_failures_are_survived(rng):
    def fun(u):
        r, J = two_bottoms(0.1)(u)
        return (r, J) if u[0] < 0.6 else (r * np.nan, J)

    found = residual_search(fun, 2, rng=rng)
    assert found.stop is StopReason.CONVERGED
    assert found.u[0, 0] == pytest.approx(0.25, abs=1e-5)


def test_without_any_finite_answer_it_says_so(rng):
    found = residual_search(lambda u: (np.full(1, np.nan), np.ones((1, 2))), 2, rng=rng)
    assert found.stop is StopReason.NO_FINITE_VALUE
    assert found.u.shape == (0, 2)


def test_the_same_seed_gives_the_same_search():
    runs = [residual_search(two_bottoms(0.1), 2, rng=np.random.default_rng(3)) for _ in range(2)]
    assert runs[0].calls == runs[1].calls
    assert runs[0].u.tolist() == runs[1].u.tolist()


def test_it_begins_where_it_is_told_and_stays_in_the_cube(rng):
    visited = []

    def watched(u):
        visited.append(u)
        return two_bottoms(0.1)(u)

    residual_search(watched, 2, rng=rng, starts=lambda points: 0.9 + 0.1 * points)
    assert min(u.min() for u in visited[:4]) >= 0.9
    assert min(u.min() for u in visited) >= 0.0
    assert max(u.max() for u in visited) <= 1.0


def test_sums_of_absolute_values_are_searched_likewise_and_outliers_do_not_move_them(rng):
    fun, truth = peak()

    def with_outliers(u):
        r, J = fun(u)
        r[::6] += 3.0
        return r, J

    found = residual_search(with_outliers, 3, rng=rng, norm=ABSOLUTES)
    assert found.stop is StopReason.CONVERGED
    assert found.u[0] == pytest.approx(truth, abs=1e-6)
    assert found.cost[0] == pytest.approx(3.0 * 11)  # every sixth of 61
    squares = residual_search(with_outliers, 3, rng=rng)
    assert np.abs(squares.u[0] - truth).max() > 1e-3


def test_both_minima_of_a_sum_of_absolute_values_are_listed(rng):
    found = residual_search(two_bottoms(0.1), 2, rng=rng, norm=ABSOLUTES)
    assert np.sort(found.u[:, 0]) == pytest.approx([0.25, 0.75], abs=1e-6)
    assert found.cost == pytest.approx([0.1, 0.1])
