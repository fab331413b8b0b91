"""The funnel: the smooth trend that minima of a rugged function follow, and where it has its bottom."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.steps import minimize_on_box

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Funnel:
    """A quadratic trend with a bottom in the unit cube."""

    bottom: Array  # (dim,)
    error: float  # foreseen from all other points, a value is off by this (rms), in standard deviations of the values


def fit_funnel(points: Array, values: Array) -> Funnel | None:
    """Return the trend of `values` (n,) over `points` (n, dim); None where there is no bowl, or too few points.

    Tried are bowls that are round, with axes along the parameters, and of any shape, as far as there are points for
    them; the one that foresees each value from the others best (PRESS) is taken. A round bowl needs dim + 4 points, and
    none of them prefers any direction.
    """
    n, dim = points.shape
    spread = float(values.std())
    if spread == 0.0:
        return None
    centre = points.mean(axis=0)
    x, y = points - centre, (values - values.mean()) / spread
    bowls = []
    for curved, unfold in _SHAPES:
        design = np.hstack([np.ones((n, 1)), x, curved(x)])
        if n < design.shape[1] + 2:
            break
        solved, error = _press(design, y)
        hessian = unfold(solved[dim + 1 :], dim)
        if np.linalg.eigvalsh(hessian)[0] > 0:
            step = minimize_on_box(solved[1 : dim + 1], hessian, -centre, 1 - centre)
            bowls.append(Funnel(bottom=centre + step, error=error))
    return min(bowls, key=lambda bowl: bowl.error, default=None)


def _press(design: Array, y: Array) -> tuple[Array, float]:
    """Return the least-squares solution, and the rms error of each value as foreseen from all others."""
    q, r = np.linalg.qr(design)
    if np.abs(np.diagonal(r)).min() < 1e-9 * np.abs(np.diagonal(r)).max():
        return np.zeros(design.shape[1]), np.inf
    solved = np.linalg.solve(r, q.T @ y)
    leverage = np.minimum((q**2).sum(axis=1), 1 - 1e-9)
    return solved, float(np.sqrt(np.mean(((y - design @ solved) / (1 - leverage)) ** 2)))


def _round(x: Array) -> Array:
    return (x**2).sum(axis=1, keepdims=True)


def _along_axes(x: Array) -> Array:
    return x**2


def _of_any_shape(x: Array) -> Array:
    rows, columns = np.triu_indices(x.shape[1])
    return x[:, rows] * x[:, columns]


def _hessian_of_any_shape(c: Array, dim: int) -> Array:
    hessian = np.zeros((dim, dim))
    hessian[np.triu_indices(dim)] = c
    return hessian + hessian.T


#: the squares of a shape (n, dim) -> (n, m), and the Hessian of their coefficients (m,)
_SHAPES = (
    (_round, lambda c, dim: 2 * c[0] * np.eye(dim)),
    (_along_axes, lambda c, dim: 2 * np.diag(c)),
    (_of_any_shape, _hessian_of_any_shape),
)
