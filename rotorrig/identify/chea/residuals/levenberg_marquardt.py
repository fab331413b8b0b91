"""Levenberg and Marquardt's method in the unit cube, where one call gives the residuals and their Jacobian.

The damping follows Nielsen ("Damping parameter in Marquardt's method", 1999), scaled by the columns' lengths
(Marquardt 1963). No step moves a parameter by more than `reach`, for the linear model of a resonance does not
hold any farther.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.steps import minimize_on_box

Array = NDArray[np.float64]
Residual = Callable[[Array], tuple[Array, Array]]  # u (dim,) -> r (figure,) and dr/du (figure, dim)

DAMPING = 0.1  # of the first step
_LEAST, _MOST = 1e-9, 1e8
_FLAT = 1e-6  # of the longest column: a shorter one is scaled as if it were this long
_TINY = np.finfo(float).tiny


@dataclass(frozen=True, slots=True)
class Point:
    """A point of the unit cube, the sum of squares there, and the linear model of its surroundings."""

    u: Array  # (dim,)
    cost: float  # r r; +inf where fun had no finite answer
    slope: Array  # (dim,) J^T r
    normal: Array  # (dim, dim) J^T J


class End(NamedTuple):
    """Where a descent ended."""

    point: Point
    kind: str  # "minimum", "steps" when it ran out of them, or what `watch` said


class Counted:
    """A function that counts its calls."""

    def __init__(self, fun: Residual) -> None:
        self._fun = fun
        self.calls = 0

    def __call__(self, u: Array) -> tuple[Array, Array]:
        """Return what the function returns."""
        self.calls += 1
        return self._fun(u)


def evaluate(fun: Residual, u: Array) -> Point:
    """Call `fun` at `u`. An answer that is not finite counts as an infinite sum of squares."""
    r, J = fun(u)
    with np.errstate(over="ignore", invalid="ignore"):
        cost = float(r @ r)
    if not (np.isfinite(cost) and np.isfinite(J).all()):
        return Point(u, np.inf, np.zeros(len(u)), np.eye(len(u)))
    return Point(u, cost, J.T @ r, J.T @ J)


def descend(
    fun: Residual,
    start: Point,
    *,
    tolerance: float,
    reach: float,
    max_steps: int,
    watch: Callable[[Point, Sequence[float]], str | None] = lambda point, costs: None,
) -> End:
    """Return the end of a descent from `start`, after at most `max_steps` calls of `fun`.

    It is a minimum when no step promises more than `tolerance` of the cost, damped or not. After every step `watch` is
    shown the lowest point and the lowest costs until then, one per step; what it returns, if anything, is the end.
    """
    point, damping, growth = start, DAMPING, 2.0
    costs = [point.cost]
    for _ in range(max_steps):
        step = _step(point, damping, reach)
        promised = _promise(point, step)
        little = tolerance * point.cost
        if damping > _MOST or (promised <= little and _promise(point, _step(point, _LEAST, reach)) <= little):
            return End(point, "minimum")
        trial = evaluate(fun, np.clip(point.u + step, 0.0, 1.0))
        if trial.cost < point.cost:
            gain = min((point.cost - trial.cost) / max(promised, _TINY), 1.0)
            damping, growth = max(damping * max(0.1, 1 - (2 * gain - 1) ** 3), _LEAST), 2.0
            point = trial
        else:
            damping, growth = damping * growth, 2 * growth
        costs.append(point.cost)
        if (why := watch(point, costs)) is not None:
            return End(point, why)
    return End(point, "steps")


def _promise(point: Point, step: Array) -> float:
    """Return by how much the cost falls along a step if the linear model holds."""
    return -float(2 * point.slope @ step + step @ point.normal @ step)


def _step(point: Point, damping: float, reach: float) -> Array:
    """Return the damped step (dim,) of least predicted cost within the cube and `reach` in every parameter."""
    low, high = np.maximum(-point.u, -reach), np.minimum(1.0 - point.u, reach)
    lengths = np.sqrt(point.normal.diagonal())
    if not lengths.any():
        return np.zeros(len(point.u))
    lengths = np.maximum(lengths, _FLAT * lengths.max())
    slope, damped = point.slope / lengths, point.normal / (lengths[:, None] * lengths)
    damped.flat[:: len(damped) + 1] += damping
    step = -np.linalg.solve(damped, slope) / lengths
    if (step >= low).all() and (step <= high).all():
        return step
    return minimize_on_box(slope, damped, low * lengths, high * lengths) / lengths
