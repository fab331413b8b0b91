"""Linear model of residuals about a point: its damped minimum within a box, and what that promises."""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from rotorrig.identify.chea.residuals.settings import LINEAR_MODEL
from rotorrig.identify.chea.steps import minimize_on_box

Array = NDArray[np.float64]


class LinearModel:
    """Linear model of the residual about `p`, in columns of unit length."""

    def __init__(
        self, J: Array, r: Array, p: Array, bounds: tuple[Array, Array], *, reach: float | Array = np.inf
    ) -> None:
        """Take the residual `r` and its Jacobian at `p`, (figure,) and (figure, parameter).

        No step goes beyond the `bounds`, nor farther than `reach` in any parameter.
        """
        self.cost = float(r @ r)
        length = np.sqrt(np.einsum("fp,fp->p", J, J))
        self._moving = length > 0
        self._length = length[self._moving]
        columns = J[:, self._moving] / self._length
        self._normal = columns.T @ columns
        self._root, self._onto = triangular_factor(columns, self._normal)
        self._independent = bool(np.abs(self._root.diagonal()).min(initial=1.0) > LINEAR_MODEL.independent)
        self._aim = -self._onto(r)
        self._p, self._r, self._J = p, r, J
        self._bounds = bounds
        self._room = self._scale_room(p, reach)
        self._best: dict[float, Array] = {}

    def best(self, damping: float) -> Array:
        """Return the minimum of the model within the bounds, its steps damped by `damping` in units of the columns."""
        if damping not in self._best:
            self._best[damping] = self._move(self._p, self._least(self._aim, damping, *self._room))
        return self._best[damping]

    def further(self, p: Array, r: Array) -> Array:
        """Return where an undamped step from elsewhere ends, where the residual is `r` and the derivatives the same."""
        return self._move(p, self._least(-self._onto(r), LINEAR_MODEL.least_damping, *self._scale_room(p, np.inf)))

    def along(self, share: float, aimed: Array) -> Array:
        """Return what lies at a share of the way to `aimed`."""
        return self._p + share * (aimed - self._p)

    def bend(self, aimed: Array, r: Array, share: float, damping: float, *, straight: float) -> Array | None:
        """Return where a step damped by `damping` to `aimed` ends if it bends as the residual does along it.

        `r` is the residual at a `share` of the step. None where that has none, and where the second derivative of the
        path, which moves its end by half, is longer than `straight` of the step: there it says nothing.
        """
        if not np.isfinite(r).all():
            return None
        step = aimed - self._p
        second = 2 / share * ((r - self._r) / share - self._J @ step)
        anywhere = np.full(len(self._length), np.inf)
        bent = self._least(-self._onto(second), max(damping, LINEAR_MODEL.least_damping), -anywhere, anywhere)
        if np.linalg.norm(bent) > straight * np.linalg.norm(step[self._moving] * self._length):
            return None
        return self._move(aimed, bent / 2)

    def promise(self, aimed: Array) -> float:
        """Return by how much the sum of squares falls on the way there if the model holds."""
        step = (aimed - self._p)[self._moving] * self._length
        return float(self._aim @ self._aim - np.sum((self._aim - self._root @ step) ** 2))

    @cached_property
    def full_promise(self) -> float:
        """Fall of the sum of squares that an undamped step promises."""
        return self.promise(self.best(LINEAR_MODEL.least_damping))

    def _scale_room(self, p: Array, reach: float | Array) -> tuple[Array, Array]:
        low, high = self._bounds
        low, high = np.maximum(low - p, -reach), np.minimum(high - p, reach)
        return low[self._moving] * self._length, high[self._moving] * self._length

    def _least(self, aim: Array, damping: float, low: Array, high: Array) -> Array:
        """Return the scaled step s of least |root s - aim|^2 + damping |s|^2 within low <= s <= high."""
        size = len(self._length)
        if self._independent or damping > LINEAR_MODEL.independent**2:
            damped, slope = self._normal + damping * np.eye(size), -self._root.T @ aim
            step = -np.linalg.solve(damped, slope)
            if (step >= low).all() and (step <= high).all():
                return step
            if np.isfinite(low).all() and np.isfinite(high).all():
                return minimize_on_box(slope, damped, low, high)
        root = np.vstack([self._root, np.sqrt(damping) * np.eye(size)])
        return np.asarray(lsq_linear(root, np.append(aim, np.zeros(size)), bounds=(low, high), method="bvls").x)

    def _move(self, p: Array, step: Array) -> Array:
        moved = p.copy()
        moved[self._moving] += step / self._length
        return np.clip(moved, *self._bounds)  # rounding may lie beyond them


def triangular_factor(columns: Array, normal: Array | None = None) -> tuple[Array, Callable[[Array], Array]]:
    """Return R of columns of unit length, (parameter or figure, parameter), and what takes a residual r to Q^T r.

    By the normal equations, `columns.T @ columns`, unless a column is nearly in the span of those before it.
    """
    normal = columns.T @ columns if normal is None else normal
    try:
        root: Array = np.asarray(np.linalg.cholesky(normal).T, dtype=np.float64)
    except np.linalg.LinAlgError:
        root = np.zeros((1, 1))
    if root.diagonal().min(initial=1.0) > LINEAR_MODEL.independent:
        return root, lambda r: np.asarray(np.linalg.solve(root.T, columns.T @ r))
    Q, R = (np.asarray(factor, dtype=np.float64) for factor in np.linalg.qr(columns))
    return R, lambda r: Q.T @ r
