"""Levenberg and Marquardt's method within bounds, along valleys that bend, with linear parameters solved for apart.

Where unknowns nearly make up for each other, the sum of squares has a narrow valley, and where they enter nonlinearly
it bends: a full step leaves it, and a damped one gets nowhere. A second step by the same derivatives leads back into
it (Shamanskii, Ukrainian Math. J. 19 (1967) 133), for the price of one residual: of a rotor with a bow or a push of the
coupling, seen by four probes, fits then end after 3 Jacobians, not 10 to 18.

While a resonance has to move by several of its widths, the amplitude of its excitation is wrong on the way; solved for
again after a step (separable least squares, Golub and Pereyra 1973), it cannot hold the rest back.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

Reals = NDArray[np.float64]

TOLERANCE = 1e-4  # of chi2: a step of a hundredth of a standard deviation
_DAMPING = 1e-5  # of the first step
_LEAST_DAMPING, _MOST_DAMPING = 1e-14, 1e6
_TRIALS = 12  # damped steps tried on one Jacobian
_BENDS = 4  # further full steps on it
_LEFT = 0.05  # of its promise: a full step that leaves less needs no further one
_IDLE = 0.01  # of its promise: a step that gains less has derivatives that are wrong
_PATIENCE = 2  # such steps in a row, and no more
_INDEPENDENT = 1e-4  # of a column's length lies beyond those before it: the normal equations keep 8 digits

Worth = Callable[[float, float], bool]  # of the sum of squares and of what a full step promises to take from it


def always(cost: float, promise: float) -> bool:
    """Go on."""
    return True


class Stop(StrEnum):
    """Why it ended."""

    CONVERGED = "converged"
    STALLED = "stalled"  # no step of any length helped, or hardly: the derivative is at its rounding
    BUDGET = "budget"  # its steps were used up
    GIVEN_UP = "given up"  # what was left to gain was not worth it


@dataclass(frozen=True, slots=True, kw_only=True)
class Minimum:
    """Where it ended."""

    p: Reals  # (parameter,)
    jacobian: Reals  # (figure, parameter) at p
    cost: float  # sum of squares
    steps: int  # Jacobians taken
    stop: Stop

    @property
    def converged(self) -> bool:
        """Whether a full step promised less than the tolerance."""
        return self.stop is Stop.CONVERGED


def minimise(
    residual: Callable[[Reals], Reals],
    jacobian: Callable[[Reals], Reals],
    start: Reals,
    *,
    bounds: tuple[Reals, Reals],
    settle: Callable[[Reals], Reals] = lambda p: p,
    tolerance: float = TOLERANCE,
    max_steps: int = 50,
    worth: Worth = always,
    damped: bool = False,
) -> Minimum:
    """Minimise the sum of squares of `residual` from `start`, which is within the bounds.

    `settle` returns its argument with the linear parameters at their best. It has converged when a full step promises
    less than `tolerance` of the sum; it is given up where `worth`, asked before every step but the first, says no.
    With `damped` no full steps are tried first and every step is settled: where a residual takes as long as a Jacobian,
    full steps cost more than they gain.
    """
    p = settle(start) if damped else start
    r, damping, idle = residual(p), _DAMPING, 0
    for step in range(1, max_steps + 1):
        J, cost = jacobian(p), float(r @ r)
        model = LinearModel(J, r, p, bounds)
        promise = model.promise(model.best(_LEAST_DAMPING))
        if promise < tolerance:
            return Minimum(p=p, jacobian=J, cost=cost, steps=step, stop=Stop.CONVERGED)
        if step > 1 and not worth(cost, promise):
            return Minimum(p=p, jacobian=J, cost=cost, steps=step, stop=Stop.GIVEN_UP)
        taken = take_step(model, residual, settle=settle, damping=damping, damped=damped)
        idle = idle + 1 if taken is None or cost - _sum(taken.r) < _IDLE * promise else 0
        if taken is None or idle == _PATIENCE:
            return Minimum(p=p, jacobian=J, cost=cost, steps=step, stop=Stop.STALLED)
        p, r, damping = taken.p, taken.r, taken.damping
    return Minimum(p=p, jacobian=jacobian(p), cost=float(r @ r), steps=max_steps, stop=Stop.BUDGET)


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A step that lowered the sum of squares."""

    p: Reals  # (parameter,) where it ended
    r: Reals  # (figure,) there
    damping: float  # of the next one


def take_step(
    model: "LinearModel",
    residual: Callable[[Reals], Reals],
    *,
    settle: Callable[[Reals], Reals] = lambda p: p,
    damping: float = _DAMPING,
    damped: bool = False,
) -> Step | None:
    """Return the full step of a linear model, or the longest damped one that helps; None if none does.

    A damped step that gains less than half of its promise is settled; if all are to be `damped`, every one is.
    """
    if not damped and (taken := _full_step(model, residual)) is not None:
        return replace(taken, damping=max(0.1 * damping, _LEAST_DAMPING))
    for _ in range(_TRIALS):
        aimed = model.best(damping)
        promised = model.promise(aimed)
        p = settle(aimed) if damped else aimed
        r = residual(p)
        if not damped and model.cost - _sum(r) < promised / 2:
            settled = settle(aimed)
            r_settled = residual(settled) if settled is not aimed else r
            if not _sum(r) < _sum(r_settled):
                p, r = settled, r_settled
        gained = model.cost - _sum(r)
        if gained > 0:
            return Step(p=p, r=r, damping=max(damping * (0.1 if gained > promised / 2 else 2.0), _LEAST_DAMPING))
        damping = min(10 * damping, _MOST_DAMPING)
    return None


def _full_step(model: "LinearModel", residual: Callable[[Reals], Reals]) -> Step | None:
    """Return the undamped step, and further ones by the same derivatives; None if it gains less than half its promise.

    Each of the further ones has to halve what is left of the promise, or it leads nowhere.
    """
    p = model.best(_LEAST_DAMPING)
    r = residual(p)
    promise = model.promise(p)
    floor = model.cost - promise
    left = _sum(r) - floor
    for _ in range(_BENDS):
        if not _LEFT * promise < left < np.inf:
            break
        p_next = model.further(p, r)
        r_next = residual(p_next)
        left_next = _sum(r_next) - floor
        if not left_next < left / 2:
            break
        p, r, left = p_next, r_next, left_next
    return Step(p=p, r=r, damping=_DAMPING) if left < promise / 2 else None


def _sum(r: Reals) -> float:
    """Return the sum of squares; infinite, or no number, where a step went far beyond where there is a motion."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(r @ r)


class LinearModel:
    """The linear model of the residual about `p`, in columns of unit length."""

    def __init__(self, J: Reals, r: Reals, p: Reals, bounds: tuple[Reals, Reals]) -> None:
        """Take the residual `r` and its Jacobian at `p`, (figure,) and (figure, parameter)."""
        self.cost = float(r @ r)
        length = np.sqrt(np.einsum("fp,fp->p", J, J))
        self._moving = length > 0
        self._length = length[self._moving]
        self._columns = J[:, self._moving] / self._length
        self._root, self._onto = triangular_factor(self._columns)
        self._aim = -self._onto(r)
        self._p = p
        self._bounds = bounds

    def best(self, damping: float) -> Reals:
        """Return the minimum of the model within the bounds, its steps damped by `damping` in units of the columns."""
        return self._moved(self._p, self._aim, damping)

    def further(self, p: Reals, r: Reals) -> Reals:
        """Return where an undamped step from elsewhere ends, where the residual is `r` and the derivatives the same."""
        return self._moved(p, -self._onto(r), _LEAST_DAMPING)

    def promise(self, aimed: Reals) -> float:
        """Return by how much the sum of squares falls on the way there if the model holds."""
        step = (aimed - self._p)[self._moving] * self._length
        return float(self._aim @ self._aim - np.sum((self._aim - self._root @ step) ** 2))

    def _moved(self, p: Reals, aim: Reals, damping: float) -> Reals:
        size = len(self._length)
        damped = np.vstack([self._root, np.sqrt(damping) * np.eye(size)])
        bounds = tuple((bound - p)[self._moving] * self._length for bound in self._bounds)
        step = lsq_linear(damped, np.append(aim, np.zeros(size)), bounds=bounds, method="bvls").x
        moved = p.copy()
        moved[self._moving] += step / self._length
        return np.clip(moved, *self._bounds)  # rounding may lie beyond them


def triangular_factor(columns: Reals) -> tuple[Reals, Callable[[Reals], Reals]]:
    """Return R of columns of unit length, (parameter or figure, parameter), and what takes a residual r to Q^T r.

    By the normal equations, unless a column is nearly in the span of those before it.
    """
    try:
        root: Reals = np.asarray(np.linalg.cholesky(columns.T @ columns).T, dtype=np.float64)
    except np.linalg.LinAlgError:
        root = np.zeros((1, 1))
    if root.diagonal().min(initial=1.0) > _INDEPENDENT:
        return root, lambda r: np.asarray(solve_triangular(root, columns.T @ r, trans="T", check_finite=False))
    Q, R = (np.asarray(factor, dtype=np.float64) for factor in np.linalg.qr(columns))
    return R, lambda r: Q.T @ r
