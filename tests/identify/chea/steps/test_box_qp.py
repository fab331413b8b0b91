"""The step within a box: corners and edges by hand, stationarity on random quadratics."""

import numpy as np
import pytest

from rotorrig.identify.chea.steps.box_qp import minimize_on_box

ONE = np.ones(2)


def test_a_minimum_inside_is_found_exactly() -> None:
    hessian = np.array([[2.0, 1.0], [1.0, 3.0]])
    wanted = np.array([0.3, -0.4])
    assert minimize_on_box(-hessian @ wanted, hessian, -ONE, ONE) == pytest.approx(wanted, abs=1e-14)


def test_on_an_edge_the_other_parameter_follows_the_coupling() -> None:
    hessian = np.array([[1.0, 0.5], [0.5, 1.0]])  # with s0 = 1: slope in s1 is 0.5 + s1 = 0
    assert minimize_on_box(np.array([-3.0, 0.0]), hessian, -ONE, ONE) == pytest.approx([1.0, -0.5])


def test_a_parameter_without_room_stays() -> None:
    assert minimize_on_box(np.array([-1.0, -1.0]), np.eye(2), np.zeros(2), np.array([0.0, 2.0])).tolist() == [0.0, 1.0]


def test_negative_curvature_leads_downhill_to_a_bound() -> None:
    assert minimize_on_box(np.array([0.1, 0.0]), np.diag([-1.0, 1.0]), -ONE, ONE).tolist() == [-1.0, 0.0]


@pytest.mark.parametrize("definite", [True, False])
def test_on_any_quadratic_the_step_is_in_the_box_not_uphill_and_stationary(definite: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(300):
        dim = int(rng.integers(1, 8))
        root = rng.standard_normal((dim, dim))
        hessian = root @ root.T if definite else root + root.T
        gradient = rng.standard_normal(dim)
        low, high = -rng.random(dim) * (rng.random(dim) > 0.3), rng.random(dim) * (rng.random(dim) > 0.3)
        s = minimize_on_box(gradient, hessian, low, high)
        assert (low <= s).all() and (s <= high).all()
        assert gradient @ s + 0.5 * s @ hessian @ s <= 0
        slope = gradient + hessian @ s
        room = np.where(slope > 0, s - low, high - s)
        assert np.minimum(np.abs(slope), room).max() < 1e-7
