"""Descent to a minimum of the sum of absolute residuals, by a sequence of linear programs in the unit cube.

Where as many residuals are nil as there are parameters, the minimum is a corner and Newton-like: each program finds the
residuals that vanish there, and convergence is quadratic (Osborne and Watson 1971). A trust region keeps it on the way.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.residuals.box_lp import minimize_absolute_on_box
from rotorrig.identify.chea.residuals.levenberg_marquardt import Residual
from rotorrig.identify.chea.residuals.settings import ABSOLUTE

Array = NDArray[np.float64]


def descend_absolute(
    fun: Residual, start: Array, *, radius: float, tolerance: float = 1e-9, max_calls: int = 100
) -> tuple[Array, float, int]:
    """Return the lowest point (dim,) met, its sum of absolute residuals, and the calls of `fun`, at least one.

    `radius` is the first step's greatest length in any parameter. The descent ends when a step promises less than
    `tolerance` of the sum.
    """
    u = start
    r, J = fun(u)
    value, calls = float(np.abs(r).sum()), 1
    while calls < max_calls and radius > ABSOLUTE.shortest:
        step = minimize_absolute_on_box(r, J, np.maximum(-u, -radius), np.minimum(1 - u, radius))
        promised = value - float(np.abs(r + J @ step).sum())
        if promised <= tolerance * value:
            break
        moved = np.clip(u + step, 0.0, 1.0)
        r_moved, J_moved = fun(moved)
        value_moved, calls = float(np.abs(r_moved).sum()), calls + 1
        gain = (value - value_moved) / promised
        if gain < ABSOLUTE.poor or not np.isfinite(gain):
            radius = ABSOLUTE.shrink * float(np.abs(step).max())
        elif gain > ABSOLUTE.good:
            radius = max(radius, ABSOLUTE.grow * float(np.abs(step).max()))
        if value_moved < value:
            u, r, J, value = moved, r_moved, J_moved, value_moved
    return u, value, calls
