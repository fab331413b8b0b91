"""Levenberg and Marquardt's method within bounds, for residuals whose linear parameters are solved for at every step.

While a resonance has to move by several of its widths, the amplitude of its excitation is wrong on the way; solved for
again after every step (separable least squares, Golub and Pereyra 1973), it cannot hold the rest back. From a nameplate
13 % off in stiffness, all eight coefficients sought, that takes 13 Jacobians, where scipy's trust region within bounds
takes 36.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

Reals = NDArray[np.float64]

TOLERANCE = 1e-4  # of chi2: a step of a hundredth of a standard deviation
_DAMPING = 1e-5  # of the first step
_LEAST_DAMPING, _MOST_DAMPING = 1e-14, 1e6
_TRIALS = 12  # steps tried on one Jacobian


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """Where it ended."""

    p: Reals  # (parameter,)
    jacobian: Reals  # (figure, parameter) at p
    cost: float  # sum of squares
    steps: int  # Jacobians taken
    converged: bool


def minimise(
    residual: Callable[[Reals], Reals],
    jacobian: Callable[[Reals], Reals],
    start: Reals,
    *,
    bounds: tuple[Reals, Reals],
    settle: Callable[[Reals], Reals] = lambda p: p,
    tolerance: float = TOLERANCE,
    max_steps: int = 50,
) -> Solution:
    """Minimise the sum of squares of `residual` from `start`, which is within the bounds.

    `settle` returns its argument with the linear parameters at their best. It has converged when a full step promises
    less than `tolerance` of the sum.
    """
    p = settle(start)
    r = residual(p)
    cost = float(r @ r)
    damping = _DAMPING
    for step in range(1, max_steps + 1):
        J = jacobian(p)
        model = _Model(J, r, p, bounds)
        if model.promise(model.best(_LEAST_DAMPING)) < tolerance:
            return Solution(p=p, jacobian=J, cost=cost, steps=step, converged=True)
        for _ in range(_TRIALS):
            aimed = np.clip(model.best(damping), *bounds)  # rounding may lie beyond them
            trial = settle(aimed)
            r_trial = residual(trial)
            cost_trial = float(r_trial @ r_trial)
            if cost_trial < cost:
                break
            damping = min(10 * damping, _MOST_DAMPING)
        else:  # no step of any length helps: the derivative is at its rounding
            return Solution(p=p, jacobian=J, cost=cost, steps=step, converged=False)
        gained = (cost - cost_trial) / model.promise(aimed)
        damping = max(damping * (0.1 if gained > 0.5 else 2.0), _LEAST_DAMPING)
        p, r, cost = trial, r_trial, cost_trial
    return Solution(p=p, jacobian=jacobian(p), cost=cost, steps=max_steps, converged=False)


class _Model:
    """The linear model of the residual about `p`, in columns of unit length."""

    def __init__(self, J: Reals, r: Reals, p: Reals, bounds: tuple[Reals, Reals]) -> None:
        length = np.linalg.norm(J, axis=0)
        self._moving = length > 0
        self._length = length[self._moving]
        columns = np.column_stack([J[:, self._moving] / self._length, r])
        triangle: Reals = np.asarray(np.linalg.qr(columns, mode="r"))  # its last column is Q^T r, without Q itself
        rows = slice(0, columns.shape[1] - 1)
        self._root, self._aim = triangle[rows, :-1], -triangle[rows, -1]
        self._p = p
        self._bounds = tuple((bound - p)[self._moving] * self._length for bound in bounds)

    def best(self, damping: float) -> Reals:
        """Return the minimum of the model within the bounds, its steps damped by `damping` in units of the columns."""
        size = len(self._length)
        damped = np.vstack([self._root, np.sqrt(damping) * np.eye(size)])
        step = lsq_linear(damped, np.append(self._aim, np.zeros(size)), bounds=self._bounds, method="bvls").x
        aimed = self._p.copy()
        aimed[self._moving] += step / self._length
        return aimed

    def promise(self, aimed: Reals) -> float:
        """Return by how much the sum of squares falls on the way there if the model holds."""
        step = (aimed - self._p)[self._moving] * self._length
        return float(self._aim @ self._aim - np.sum((self._aim - self._root @ step) ** 2))
