"""Descents whose ends are known by hand."""

import numpy as np
import pytest

from rotorrig.identify.chea.residuals.levenberg_marquardt import Counted, Point, descend, evaluate

USUAL = {"tolerance": 1e-12, "reach": 0.25, "max_steps": 100}


def valley(u):
    """Rosenbrock's function as a sum of squares, [-2, 2]^2 on the cube; its minimum 0 is at (1, 1)."""
    x, y = 4 * u - 2
    return np.array([10 * (y - x**2), 1 - x]), 4 * np.array([[-20 * x, 10.0], [-1.0, 0.0]])


def line(target):
    """Return the distance from `target`, each parameter by itself."""
    return lambda u: (u - target, np.eye(len(u)))


def test_a_curved_valley_is_followed_to_its_bottom():
    end = descend(valley, evaluate(valley, np.array([0.1, 0.9])), **USUAL)
    assert end.kind == "minimum"
    assert 4 * end.point.u - 2 == pytest.approx([1.0, 1.0], abs=1e-6)


def test_a_minimum_outside_the_cube_is_sought_on_its_face():
    fun = line(np.array([1.7, 0.3, -0.2]))
    end = descend(fun, evaluate(fun, np.full(3, 0.5)), **USUAL)
    assert end.point.u.tolist() == pytest.approx([1.0, 0.3, 0.0])
    assert end.point.cost == pytest.approx(0.7**2 + 0.2**2)


def test_on_a_face_the_other_parameters_go_on():
    def tied(u):
        """The sum is wanted at 1.2 and the second parameter at 0.9, but the first cannot be less than 0."""
        return np.array([3 * (u[0] + u[1] - 0.4), u[1] - 0.9]), np.array([[3.0, 3.0], [0.0, 1.0]])

    end = descend(tied, evaluate(tied, np.array([0.2, 0.2])), **USUAL)
    assert end.point.u == pytest.approx([0.0, 0.45])  # of 9 (y - 0.4)^2 + (y - 0.9)^2


def test_no_point_outside_the_cube_and_no_step_beyond_the_reach():
    visited = []

    def watched(u):
        visited.append(u)
        return valley(u)

    descend(watched, evaluate(watched, np.array([0.02, 0.98])), tolerance=1e-12, reach=0.05, max_steps=200)
    points = np.array(visited)
    assert points.min() >= 0.0
    assert points.max() <= 1.0
    accepted = [points[0]]
    for u in points[1:]:
        assert np.abs(u - accepted[-1]).max() <= 0.05 + 1e-12
        if evaluate(valley, u).cost < evaluate(valley, accepted[-1]).cost:
            accepted.append(u)


def test_it_ends_when_its_steps_are_used_up():
    counted = Counted(valley)
    end = descend(counted, evaluate(counted, np.array([0.1, 0.9])), tolerance=1e-12, reach=0.01, max_steps=7)
    assert end.kind == "steps"
    assert counted.calls == 1 + 7


def test_whoever_watches_may_end_it():
    end = descend(
        valley,
        evaluate(valley, np.array([0.1, 0.9])),
        **USUAL,
        watch=lambda point, costs: "enough" if len(costs) == 4 else None,
    )
    assert end.kind == "enough"


def test_where_there_is_no_answer_it_does_not_go():
    def cliff(u):
        r, J = line(np.array([0.9]))(u)
        return (r, J) if u[0] < 0.7 else (r * np.nan, J)

    end = descend(cliff, evaluate(cliff, np.array([0.1])), **USUAL)
    assert 0.69 < end.point.u[0] < 0.7
    assert np.isfinite(end.point.cost)


@pytest.mark.parametrize("answer", [np.inf, np.nan, 1e200])
def test_an_answer_that_is_not_finite_costs_infinitely(answer):
    assert evaluate(lambda u: (np.array([answer]), np.ones((1, 1))), np.zeros(1)).cost == np.inf


def test_flat_ground_is_a_minimum():
    flat = Point(np.full(2, 0.5), 3.0, np.zeros(2), np.zeros((2, 2)))
    assert descend(valley, flat, **USUAL) == (flat, "minimum")
