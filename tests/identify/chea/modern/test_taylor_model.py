"""What the model makes of polynomials, where the answer is the polynomial."""

import numpy as np
import pytest

from rotorrig.identify.chea.modern.taylor_model import TaylorModel, fit

CENTRE = np.array([0.4, 0.7])
HESSIAN = np.array([[4.0, 1.0], [1.0, 2.0]])
GRADIENT = np.array([1.0, -2.0])


def quadratic(u: np.ndarray) -> np.ndarray:
    s = u - CENTRE
    return 7.0 + s @ GRADIENT + 0.5 * ((s @ HESSIAN) * s).sum(axis=1)


def banana(u: np.ndarray) -> np.ndarray:
    x, y = u.T
    return 100 * (y - x**2) ** 2 + (1 - x) ** 2


def fitted(fun, n: int, *, radius: float = 0.2, hessian: np.ndarray | None = None, spread: float = 0.3) -> TaylorModel:
    offsets = np.random.default_rng(3).uniform(-spread, spread, (n - 1, 2))
    points = np.vstack([CENTRE, CENTRE + offsets])
    known = np.zeros((2, 2)) if hessian is None else hessian
    return fit(points, fun(points), centre=CENTRE, radius=radius, hessian=known)


def test_six_points_fix_a_quadratic_in_the_plane() -> None:
    model = fitted(quadratic, 6)
    at_centre = np.zeros(2)
    assert model.fun == pytest.approx(7.0, abs=1e-3)
    assert model.gradient(at_centre) / model.radius == pytest.approx(GRADIENT, abs=5e-2)
    assert model.hessian(at_centre) / model.radius**2 == pytest.approx(HESSIAN, abs=0.2)


def test_three_points_are_enough_where_the_hessian_is_known() -> None:
    model = fitted(quadratic, 3, hessian=HESSIAN)
    assert model.gradient(np.zeros(2)) / model.radius == pytest.approx(GRADIENT, abs=1e-6)


def test_a_polynomial_of_fourth_degree_is_met_far_from_the_centre() -> None:
    model = fitted(banana, 40)
    u = CENTRE + np.array([0.2, -0.15])
    assert model.value((u - CENTRE) / model.radius) == pytest.approx(banana(u[None])[0], rel=1e-3)


def test_gradient_and_hessian_are_the_derivatives_of_the_value() -> None:
    model = fitted(banana, 12)
    x, step = np.array([0.3, -0.5]), 1e-5
    for i, e in enumerate(step * np.eye(2)):
        assert model.gradient(x)[i] == pytest.approx((model.value(x + e) - model.value(x - e)) / (2 * step), rel=1e-5)
        assert model.hessian(x)[i] == pytest.approx(
            (model.gradient(x + e) - model.gradient(x - e)) / (2 * step), rel=1e-5
        )


def test_a_direction_without_points_is_in_doubt_and_no_other() -> None:
    line = CENTRE + np.array([[-0.2, 0.0], [-0.1, 0.0], [0.0, 0.0], [0.1, 0.0], [0.2, 0.0]])
    doubt = np.sqrt(np.diag(fit(line, quadratic(line), centre=CENTRE, radius=0.2, hessian=HESSIAN).doubt))
    assert doubt[1] > 1e4
    assert doubt[0] < 10


def test_a_distant_point_does_not_spoil_what_near_ones_say() -> None:
    points = np.vstack([CENTRE, CENTRE + np.random.default_rng(3).uniform(-0.05, 0.05, (5, 2))])
    values = quadratic(points)
    model = fit(
        np.vstack([points, CENTRE + 0.6]), np.append(values, 30.0), centre=CENTRE, radius=0.05, hessian=np.zeros((2, 2))
    )
    assert model.gradient(np.zeros(2)) / model.radius == pytest.approx(GRADIENT, abs=0.1)
