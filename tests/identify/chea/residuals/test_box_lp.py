"""Least sums of absolute values in a box: medians by hand, and scipy's linear programs on anything else."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

from rotorrig.identify.chea.residuals.box_lp import minimize_absolute_on_box

Array = NDArray[np.float64]


def least_by_linear_program(r: Array, J: Array, low: Array, high: Array) -> float:
    """Minimise sum t over s and t, where -t <= r + J s <= t."""
    figures, dim = J.shape
    found = linprog(
        np.append(np.zeros(dim), np.ones(figures)),
        A_ub=np.block([[J, -np.eye(figures)], [-J, -np.eye(figures)]]),
        b_ub=np.append(-r, r),
        bounds=[*zip(low, high, strict=True), *[(0.0, None)] * figures],
    )
    assert found.status == 0
    return float(found.fun)


def problem(kind: str, rng: np.random.Generator) -> tuple[Array, Array]:
    figures, dim = int(rng.integers(1, 40)), int(rng.integers(1, 7))
    r, J = rng.standard_normal(figures), rng.standard_normal((figures, dim))
    if kind == "of columns of any length":
        J *= 10.0 ** rng.uniform(-5, 2, dim)
    elif kind == "of small integers":
        r, J = np.round(r), np.round(J)
    elif kind == "of which most can vanish":
        r = np.where(rng.random(figures) < 0.7, J @ rng.uniform(-0.2, 0.2, dim), r)
    elif kind == "of parameters that act alike":
        J[:, -1] = J[:, 0]
    return r, J


@pytest.mark.parametrize(
    "kind",
    [
        "of any kind",
        "of columns of any length",
        "of small integers",
        "of which most can vanish",
        "of parameters that act alike",
    ],
)
def test_the_sum_is_the_linear_programs_on_problems(kind: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(40):
        r, J = problem(kind, rng)
        low, high = (sign * rng.random(J.shape[1]) * (rng.random(J.shape[1]) > 0.2) for sign in (-1, 1))
        s = minimize_absolute_on_box(r, J, low, high)
        assert (low <= s).all() and (s <= high).all()
        want = least_by_linear_program(r, J, low, high)
        assert np.abs(r + J @ s).sum() == pytest.approx(want, rel=1e-7, abs=1e-7 * np.abs(r).sum())


def test_a_constant_goes_to_the_median_and_no_farther_than_the_side() -> None:
    r, J = -np.array([0.1, 0.2, 0.35, 0.8, 0.9]), np.ones((5, 1))
    assert minimize_absolute_on_box(r, J, -np.ones(1), np.ones(1)).tolist() == [0.35]
    assert minimize_absolute_on_box(r, J, -np.ones(1), np.full(1, 0.3)).tolist() == [0.3]
    assert minimize_absolute_on_box(r, J, -np.ones(1), np.zeros(1)).tolist() == [0.0]


def test_residuals_that_nothing_moves_are_left_as_they_are() -> None:
    assert minimize_absolute_on_box(np.ones(3), np.zeros((3, 2)), -np.ones(2), np.ones(2)).tolist() == [0.0, 0.0]


def test_where_there_is_no_answer_there_is_no_step() -> None:
    assert minimize_absolute_on_box(np.full(3, np.nan), np.ones((3, 2)), -np.ones(2), np.ones(2)).tolist() == [0.0, 0.0]
