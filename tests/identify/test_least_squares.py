"""Levenberg and Marquardt's method within bounds, on problems whose minima are known."""

import numpy as np
import pytest

from rotorrig.identify.least_squares import minimise

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


def test_linear_parameters_are_settled_at_every_step() -> None:
    t = np.linspace(0, 3, 40)
    measured = 7e-6 * np.exp(-1.3 * t)
    asked = []

    def settle(p: np.ndarray) -> np.ndarray:
        shape = np.exp(-p[1] * t)
        return np.array([shape @ measured / (shape @ shape), p[1]])

    def residual(p: np.ndarray) -> np.ndarray:
        asked.append(p)
        return (p[0] * np.exp(-p[1] * t) - measured) / 1e-9

    def jacobian(p: np.ndarray) -> np.ndarray:
        return np.column_stack([np.exp(-p[1] * t), -p[0] * t * np.exp(-p[1] * t)]) / 1e-9

    found = minimise(residual, jacobian, np.array([1.0, 4.0]), bounds=FREE, settle=settle)
    np.testing.assert_allclose(found.p, [7e-6, 1.3], rtol=1e-6)
    assert all(np.array_equal(p, settle(p)) for p in asked)
    assert found.steps < 10


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
    found = minimise(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=FREE, max_steps=steps)
    assert not found.converged
    assert found.steps == steps
    assert found.cost == pytest.approx(float(rosenbrock(found.p) @ rosenbrock(found.p)))
