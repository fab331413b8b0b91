"""Descents whose ends are known by hand: from far off, in the unit cube, and full steps within any bounds."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.chea.residuals import (
    FIT,
    SEARCH,
    Counted,
    Minimum,
    Point,
    Progress,
    Stop,
    minimize_squares,
)

FREE = (np.full(2, -np.inf), np.full(2, np.inf))


def descend(fun, start, *, share=1e-12, reach=0.25, max_calls=100, **more):
    """Descend from `start` as a search does, in the unit cube."""
    counted = fun if isinstance(fun, Counted) else Counted(fun)
    cube = np.zeros(len(start)), np.ones(len(start))
    how = {"settings": replace(SEARCH, reach=reach), "share": share, "max_steps": 500, "max_calls": max_calls}
    return minimize_squares(counted, counted(start), bounds=cube, **how, **more)


def fit(residual, jacobian, start, *, tolerance=1e-4, **more) -> Minimum:
    """Descend from `start` as a fit does, the Jacobian asked for where a step ends."""

    def evaluate(p):
        return Point(p, residual(p), lambda: jacobian(p))

    return minimize_squares(evaluate, evaluate(start), tolerance=tolerance, **more)


def valley(u):
    """Rosenbrock's function as a sum of squares, [-2, 2]^2 on the cube; its minimum 0 is at (1, 1)."""
    x, y = 4 * u - 2
    return np.array([10 * (y - x**2), 1 - x]), 4 * np.array([[-20 * x, 10.0], [-1.0, 0.0]])


def line(target):
    """Return the distance from `target`, each parameter by itself."""
    return lambda u: (u - target, np.eye(len(u)))


def test_a_curved_valley_is_followed_to_its_bottom():
    end = descend(valley, np.array([0.1, 0.9]))
    assert end.stop is Stop.CONVERGED
    assert 4 * end.point.p - 2 == pytest.approx([1.0, 1.0], abs=1e-6)


def test_a_minimum_outside_the_cube_is_sought_on_its_face():
    fun = line(np.array([1.7, 0.3, -0.2]))
    end = descend(fun, np.full(3, 0.5))
    assert end.point.p.tolist() == pytest.approx([1.0, 0.3, 0.0])
    assert end.point.cost == pytest.approx(0.7**2 + 0.2**2)


def test_on_a_face_the_other_parameters_go_on():
    def tied(u):
        """The sum is wanted at 1.2 and the second parameter at 0.9, but the first cannot be less than 0."""
        return np.array([3 * (u[0] + u[1] - 0.4), u[1] - 0.9]), np.array([[3.0, 3.0], [0.0, 1.0]])

    end = descend(tied, np.array([0.2, 0.2]))
    assert end.point.p == pytest.approx([0.0, 0.45])  # of 9 (y - 0.4)^2 + (y - 0.9)^2


def test_no_point_outside_the_cube_and_no_step_beyond_the_reach():
    visited = []

    def watched(u):
        visited.append(u)
        return valley(u)

    descend(watched, np.array([0.02, 0.98]), reach=0.05, max_calls=200)
    points = np.array(visited)
    assert points.min() >= 0.0
    assert points.max() <= 1.0
    accepted = [points[0]]
    for u in points[1:]:
        assert np.abs(u - accepted[-1]).max() <= 0.05 + 1e-12
        if Counted(valley)(u).cost < Counted(valley)(accepted[-1]).cost:
            accepted.append(u)


def test_it_ends_when_its_calls_are_used_up():
    counted = Counted(valley)
    end = descend(counted, np.array([0.1, 0.9]), reach=0.01, max_calls=7)
    assert end.stop is Stop.BUDGET
    assert end.calls == 7
    assert counted.calls == 1 + 7


def test_whoever_watches_may_end_it():
    end = descend(valley, np.array([0.1, 0.9]), watch=lambda at: Stop.ENOUGH if len(at.costs) >= 4 else None)
    assert end.stop is Stop.ENOUGH


def test_where_there_is_no_answer_it_does_not_go():
    def cliff(u):
        r, J = line(np.array([0.9]))(u)
        return (r, J) if u[0] < 0.7 else (r * np.nan, J)

    end = descend(cliff, np.array([0.1]))
    assert 0.69 < end.point.p[0] < 0.7
    assert np.isfinite(end.point.cost)


@pytest.mark.parametrize("answer", [np.inf, np.nan, 1e200])
def test_an_answer_that_is_not_finite_costs_infinitely(answer):
    assert Counted(lambda u: (np.array([answer]), np.ones((1, 1))))(np.zeros(1)).cost == np.inf


def test_a_jacobian_that_is_not_finite_costs_infinitely():
    assert Counted(lambda u: (np.ones(1), np.full((1, 1), np.nan)))(np.zeros(1)).cost == np.inf


def test_flat_ground_is_a_minimum():
    end = descend(lambda u: (np.full(1, 3.0), np.zeros((1, 2))), np.full(2, 0.5))
    assert (end.stop, end.calls, end.point.p.tolist()) == (Stop.CONVERGED, 0, [0.5, 0.5])


def rosenbrock(p: np.ndarray) -> np.ndarray:
    return np.array([10 * (p[1] - p[0] ** 2), 1 - p[0]])


def slopes(p: np.ndarray) -> np.ndarray:
    return np.array([[-20 * p[0], 10.0], [-1.0, 0.0]])


def test_the_end_of_the_curved_valley_is_found() -> None:
    found = fit(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=FREE, tolerance=1e-20)
    assert found.converged
    np.testing.assert_allclose(found.point.p, [1, 1], atol=1e-8)
    np.testing.assert_array_equal(found.point.J, slopes(found.point.p))


def test_a_minimum_outside_the_bounds_ends_on_the_nearest_side() -> None:
    found = fit(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=(FREE[0], np.array([0.5, np.inf])))
    assert found.converged
    np.testing.assert_allclose(found.point.p, [0.5, 0.25], atol=1e-4)
    assert found.point.p[0] <= 0.5


def test_a_valley_that_bends_is_followed_to_its_end_on_a_few_jacobians() -> None:
    found = fit(rosenbrock, slopes, np.array([-1.2, 1.0]), bounds=FREE)
    assert found.converged
    assert found.steps <= 4  # damped steps alone take 20 to 30
    np.testing.assert_allclose(found.point.p, [1, 1], atol=1e-4)


def test_a_full_step_ends_where_a_large_residual_that_bends_is_least() -> None:
    def residual(p: np.ndarray) -> np.ndarray:
        return np.array([1e3 + 5e-4 * p[0] ** 2, p[0] - 1])  # squared: 1e6 + p^2 + (p - 1)^2, least at a half

    def jacobian(p: np.ndarray) -> np.ndarray:
        return np.array([[1e-3 * p[0]], [1.0]])

    found = fit(residual, jacobian, np.zeros(1), bounds=(np.full(1, -np.inf), np.full(1, np.inf)))
    assert found.converged
    assert (found.steps, found.calls) == (2, 3)  # without, it stalls at 1
    assert found.point.p[0] == pytest.approx(0.5, abs=1e-3)


def test_a_damped_step_follows_the_bend_of_a_valley() -> None:
    def residual(p: np.ndarray) -> np.ndarray:
        return np.array([1e3 * (np.hypot(*p) - 1), p[0] - 0.99])  # a ring, 1e-3 wide

    def jacobian(p: np.ndarray) -> np.ndarray:
        return np.array([1e3 * p / np.hypot(*p), [1.0, 0.0]])

    found = fit(residual, jacobian, np.array([-0.9, 0.4]), bounds=FREE, max_steps=50)
    assert found.point.p == pytest.approx([0.93, 0.36], abs=0.05)  # almost there; without, it stalls at (0.01, 1)


def test_linear_parameters_are_settled_after_every_damped_step() -> None:
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

    found = fit(
        residual,
        jacobian,
        np.array([1.0, 4.0]),
        bounds=FREE,
        settings=replace(FIT, full_steps=False),
        solve_linear=settle,
    )
    np.testing.assert_allclose(found.point.p, [7e-6, 1.3], rtol=1e-6)
    assert settled
    assert found.steps < 10


@pytest.mark.parametrize("least", [0.0, 1e9])
def test_what_is_not_worth_going_on_with_is_given_up_after_the_first_step(least: float) -> None:
    asked: list[tuple[float, float]] = []

    def watch(at: Progress) -> Stop | None:
        asked.append((at.point.cost, at.model.full_promise))
        return None if at.model.full_promise > least else Stop.GIVEN_UP

    found = fit(np.square, lambda p: np.diag(2 * p), np.array([100.0, 3.0]), bounds=FREE, watch=watch)
    assert (found.stop is Stop.GIVEN_UP) == (least > 0)
    assert found.converged == (least == 0)
    cost, promise = asked[0]
    assert promise <= cost < 100.0**4 + 3.0**4
    if least:
        assert found.steps == 2
        assert found.point.cost == cost
        np.testing.assert_array_equal(found.point.J, np.diag(2 * found.point.p))


def test_a_direction_that_nothing_depends_on_is_left_alone() -> None:
    slope = np.array([[1.0, 0.0]])
    found = fit(lambda p: np.array([p[0] - 3]), lambda p: slope, np.array([0.0, 5.0]), bounds=FREE)
    assert found.converged
    np.testing.assert_allclose(found.point.p, [3, 5], atol=1e-3)


def test_nearly_tied_parameters_stop_at_the_bound_that_comes_first() -> None:
    A, b = np.array([[1.0, 1.0], [0.0, 1e-3]]), np.array([1.5, 1.0])  # without bounds at (-998.5, 1000)
    unit = (np.zeros(2), np.ones(2))
    found = fit(lambda p: A @ p - b, lambda p: A, np.array([0.2, 0.2]), bounds=unit, tolerance=1e-12)
    assert found.converged
    np.testing.assert_allclose(found.point.p, [0.5, 1.0], atol=2e-3)


def test_steps_to_where_the_residual_is_no_number_are_taken_back() -> None:
    def residual(p: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):
            return np.array([np.log(p[0]) + 8.0])

    bounds = (np.array([-5.0]), np.array([9.0]))
    found = fit(residual, lambda p: np.array([[1 / p[0]]]), np.array([1.0]), bounds=bounds, tolerance=1e-8)
    np.testing.assert_allclose(found.point.p, np.exp(-8.0), rtol=1e-3)


@pytest.mark.parametrize("steps", [1, 3])
def test_it_stops_when_its_steps_are_used_up_and_says_so(steps: int) -> None:
    found = fit(np.square, lambda p: np.diag(2 * p), np.array([100.0, 3.0]), bounds=FREE, max_steps=steps)
    assert found.stop is Stop.BUDGET
    assert not found.converged
    assert found.steps == steps
    assert found.point.cost == pytest.approx(np.sum(found.point.p**4))
