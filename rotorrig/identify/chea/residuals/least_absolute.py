"""Descent to a minimum of the sum of absolute residuals, by a sequence of linear programs in the unit cube.

Where as many residuals are nil as there are parameters, the minimum is a corner and Newton-like: each program finds the
residuals that vanish there, and convergence is quadratic (Osborne and Watson 1971). A trust region keeps it on the way.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.box_lp import minimize_absolute_on_box
from rotorrig.identify.chea.residuals.levenberg_marquardt import Stop
from rotorrig.identify.chea.residuals.point import Counted, Point, Residual, Residuals, answering
from rotorrig.identify.chea.residuals.settings import ABSOLUTE

Array = NDArray[np.float64]


def descend_absolute(
    fun: Residual, start: Array, *, radius: float, tolerance: float = 1e-9, max_calls: int = 100
) -> tuple[Array, float, int]:
    """Return the lowest point (dim,) met, its sum of absolute residuals, and the calls of `fun`, at least one.

    `radius` is the first step's greatest length in any parameter. The descent ends when a step promises less than
    `tolerance` of the sum.
    """
    counted = Counted(fun)
    descent = answering(lower_absolute)
    point, _ = descent(counted, counted(start), reach=radius, share=tolerance, max_calls=max_calls - 1)
    return point.p, sum_of_absolutes(point.r), counted.calls


def lower_absolute(
    start: Point,
    *,
    reach: float,
    share: float,
    max_calls: int,
    watch: Callable[[Point, Sequence[float]], Stop | None] = lambda point, values: None,
) -> Residuals[tuple[Point, Stop]]:
    """Descend likewise from a point whose residuals are known; `watch` sees the lowest and the sums so far.

    `reach` is the radius, `share` the tolerance.
    """
    point, values, radius = start, [sum_of_absolutes(start.r)], reach
    while len(values) <= max_calls:
        u, value = point.p, values[-1]
        if radius <= ABSOLUTE.shortest:
            return point, Stop.STALLED
        step = minimize_absolute_on_box(point.r, point.J, np.maximum(-u, -radius), np.minimum(1 - u, radius))
        promised = value - sum_of_absolutes(point.r + point.J @ step)
        if promised <= share * value:
            return point, Stop.CONVERGED
        if len(values) > 1 and (why := watch(point, values)):
            return point, why
        moved = yield np.clip(u + step, 0.0, 1.0)
        value_moved = sum_of_absolutes(moved.r)
        gain = (value - value_moved) / promised
        if gain < ABSOLUTE.poor or not np.isfinite(gain):
            radius = ABSOLUTE.shrink * float(np.abs(step).max())
        elif gain > ABSOLUTE.good:
            radius = max(radius, ABSOLUTE.grow * float(np.abs(step).max()))
        if value_moved < value:
            point = moved
        values.append(min(value, value_moved))
    return point, Stop.BUDGET


def sum_of_absolutes(r: Array) -> float:
    """Return the sum of absolute residuals; infinite where one is no number.

    >>> sum_of_absolutes(np.array([1.0, -2.0]))
    3.0
    """
    value = float(np.abs(r).sum())
    return value if np.isfinite(value) else np.inf
