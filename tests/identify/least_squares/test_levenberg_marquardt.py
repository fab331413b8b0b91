"""Levenberg and Marquardt's method within bounds, on problems whose minima are known."""

import numpy as np
import pytest

from rotorrig.identify.least_squares.levenberg_marquardt import Stop, minimise, triangular_factor

FREE = (np.full(2, -np.inf), np.full(2, np.inf))


def rosenbrock(p: np.ndarray) -> np.ndarray:
    return np.array([10 * (p[1] - p[0] ** 2), 1 - p[0]])


def slopes(p: np.ndarray) -> np.ndarray:
    return np.array([[-20 * p[0], 10.0], [-1.0, 0.0]])


def test_the_end_of_the_curved_valley_is_found() -> None:
    found = minimise(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=FREE, tolerance=1e-20)
    assert found.converged
    np.testing.assert_allclose(found.p, [1, 1], atol=1e-8)
    np.testing.assert_array_equal(found.jacobian, slopes(found.p))


def test_a_minimum_outside_the_bounds_ends_on_the_nearest_side() -> None:
    found = minimise(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=(FREE[0], np.array([0.5, np.inf])))
    assert found.converged
    np.testing.assert_allclose(found.p, [0.5, 0.25], atol=1e-4)
    assert found.p[0] <= 0.5


def test_a_valley_that_bends_is_followed_to_its_end_on_a_few_jacobians() -> None:
    found = minimise(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=FREE)
    assert found.converged
    assert found.steps <= 4  # damped steps alone take 20 to 30
    np.testing.assert_allclose(found.p, [1, 1], atol=1e-4)


def test_linear_parameters_are_settled_where_a_step_gains_little() -> None:
    t = np.linspace(0, 3, 40)
    measured = 7e-6 * np.exp(-1.3 * t)
    settled = []

    def settle(p: np.ndarray) -> np.ndarray:
        shape = np.exp(-p[1] * t)
        settled.append(np.array([shape @ measured / (shape @ shape), p[1]]))
        return settled[-1]

    def residual(p: np.ndarray) -> np.ndarray:
        return (p[0] * np.exp(-p[1] * t) - measured) / 1e-9

    def jacobian(p: np.ndarray) -> np.ndarray:
        return np.column_stack([np.exp(-p[1] * t), -p[0] * t * np.exp(-p[1] * t)]) / 1e-9

    found = minimise(residual, jacobian, np.array([1.0, 4.0]), bounds=FREE, settle=settle)
    np.testing.assert_allclose(found.p, [7e-6, 1.3], rtol=1e-6)
    assert settled
    assert found.steps < 10


@pytest.mark.parametrize("least", [0.0, 1e9])
def test_what_is_not_worth_going_on_with_is_given_up_after_the_first_step(least: float) -> None:
    asked: list[tuple[float, float]] = []

    def worth(cost: float, promise: float) -> bool:
        asked.append((cost, promise))
        return promise > least

    found = minimise(np.square, lambda p: np.diag(2 * p), np.array([100.0, 3.0]), bounds=FREE, worth=worth)
    assert (found.stop is Stop.GIVEN_UP) == (least > 0)
    assert found.converged == (least == 0)
    cost, promise = asked[0]
    assert promise <= cost < 100.0**4 + 3.0**4
    if least:
        assert found.steps == 2
        assert found.cost == cost
        np.testing.assert_array_equal(found.jacobian, np.diag(2 * found.p))


@pytest.mark.parametrize("near", [0.5, 1e-7, 0.0])
def test_columns_that_are_alike_have_the_triangle_of_their_products(near: float) -> None:
    columns = np.array([[1.0, 1.0], [0.0, near], [0.0, 0.0]])
    columns /= np.linalg.norm(columns, axis=0)
    root, onto = triangular_factor(columns)
    np.testing.assert_allclose(root.T @ root, columns.T @ columns, atol=1e-15)
    inside, across = columns @ [2.0, -3.0], np.array([0.0, 0.0, 4.0])
    np.testing.assert_allclose(root.T @ onto(inside + across), columns.T @ inside, atol=1e-12)
    assert np.linalg.norm(onto(across)) < 1e-12


def test_a_direction_that_nothing_depends_on_is_left_alone() -> None:
    slope = np.array([[1.0, 0.0]])
    found = minimise(lambda p: np.array([p[0] - 3]), lambda p: slope, np.array([0.0, 5.0]), bounds=FREE)
    assert found.converged
    np.testing.assert_allclose(found.p, [3, 5], atol=1e-3)


def test_nearly_tied_parameters_stop_at_the_bound_that_comes_first() -> None:
    A, b = np.array([[1.0, 1.0], [0.0, 1e-3]]), np.array([1.5, 1.0])  # without bounds at (-998.5, 1000)
    unit = (np.zeros(2), np.ones(2))
    found = minimise(lambda p: A @ p - b, lambda p: A, np.array([0.2, 0.2]), bounds=unit, tolerance=1e-12)
    assert found.converged
    np.testing.assert_allclose(found.p, [0.5, 1.0], atol=2e-3)


def test_steps_to_where_the_residual_is_no_number_are_taken_back() -> None:
    def residual(p: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):
            return np.array([np.log(p[0]) + 8.0])

    bounds = (np.array([-5.0]), np.array([9.0]))
    found = minimise(residual, lambda p: np.array([[1 / p[0]]]), np.array([1.0]), bounds=bounds, tolerance=1e-8)
    np.testing.assert_allclose(found.p, np.exp(-8.0), rtol=1e-3)


@pytest.mark.parametrize("steps", [1, 3])
def test_it_stops_when_its_steps_are_used_up_and_says_so(steps: int) -> None:
    found = minimise(np.square, lambda p: np.diag(2 * p), np.array([100.0, 3.0]), bounds=FREE, max_steps=steps)
    assert found.stop is Stop.BUDGET
    assert not found.converged
    assert found.steps == steps
    assert found.cost == pytest.approx(np.sum(found.p**4))
