"""Local search by sequential quadratic programming (section 2.4): scipy's SLSQP in the unit cube."""

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

STEP = 1.5e-8  # of the forward differences: the square root of the float's resolution


def descend(evaluate: Callable[[Array], Array], start: Array, value: float) -> tuple[Array, float]:
    """Return the lowest point (dim,) met on a descent from `start`, where the function is `value`, and its value.

    `evaluate` takes points (n, dim) of the unit cube and returns (n,); a gradient is one such batch of dim points.
    A non-finite difference counts as no slope in that direction.
    """
    best = start, value
    if not np.isfinite(value):
        return best
    slope = _slope(evaluate, start, value)
    scale = float(np.abs(slope).max())
    if scale == 0.0:
        return best
    # SLSQP's tolerance is absolute. With the steepest initial slope made 1, neither the unit of the function nor a
    # constant added to it matters; unscaled, an objective in metres squared stops at once.
    met: dict[bytes, float] = {start.tobytes(): value}

    def value_at(u: Array) -> float:
        nonlocal best
        if u.tobytes() not in met:
            met[u.tobytes()] = float(evaluate(u[None])[0])
        f = met[u.tobytes()]
        if f < best[1]:
            best = u.copy(), f
        return f

    def scaled_value(u: Array) -> float:
        return value_at(u) / scale

    def scaled_slope(u: Array) -> Array:
        return (slope if np.array_equal(u, start) else _slope(evaluate, u, value_at(u))) / scale

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Values in x were outside bounds")  # scipy clips them
        minimize(
            scaled_value,
            start,
            jac=scaled_slope,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(start),
            options={"ftol": 1e-10, "maxiter": 50 * len(start)},
        )
    return best


def _slope(evaluate: Callable[[Array], Array], u: Array, value: float) -> Array:
    """Return forward differences (dim,), backward at the upper bound."""
    steps = np.where(u + STEP <= 1.0, STEP, -STEP)
    moved = u + np.diag(steps)
    slope = (evaluate(moved) - value) / (np.diagonal(moved) - u)  # the step as the floats have it
    return np.where(np.isfinite(slope), slope, 0.0)
