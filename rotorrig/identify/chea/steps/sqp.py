"""Local search by sequential quadratic programming (section 2.4), within the unit cube.

Bounds are the only constraints here, so the quadratic subproblem has a box for its region, and the merit function is
the function itself. The Hessian is Powell's damped BFGS update (Powell 1978, the chapter's reference); written as a
generator, so that a search can be asked for its next points.

Eqs. (15) and (16) are sums of absolute values, with a kink wherever one of them is nothing. Quasi-Newton steps cross
kinks if the line search also asks that the slope has risen (Lewis and Overton, "Nonsmooth optimization via quasi-Newton
methods", 2013), and if a finite difference is shorter than the way to the next kink. On Table 7, f2 rises 13,000 times
its unit across a kink in the stiffness and 0.3 along the kink, toward the damping sought: a difference of 1.5e-8 of
the cube is blind 2e-4 above the kink, and descents end there, one of 1e-10 is not.
"""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.session import Evaluations, Record
from rotorrig.identify.chea.steps.box_qp import minimize_on_box
from rotorrig.identify.chea.steps.settings import STEPS

Array = NDArray[np.float64]


def descend(
    record: Record, start: Array, value: float, *, near: float = 0.0, tolerance: float = 1e-5, max_steps: int = 400
) -> Evaluations[tuple[Array, float]]:
    """Return the lowest point (dim,) met on a descent from `start`, where the function is `value`, and its value.

    A gradient is one batch of dim points; a non-finite difference counts as no slope in that direction. When the slope
    has fallen to `tolerance` of the first one, and the next step promises less than its square of all that was gained,
    one more step is taken, without a gradient at its end, and the descent is over. Neither unit nor offset of fun
    matters in this, nor, in the second, how much steeper some parameters are than others. It is also over where it
    comes within `near`, in every parameter, of a minimum the record knows: where it leads is then known too.

    Where nothing lower lies on a step that promised more, finite differences become shorter, once: there is a kink, or
    a curvature so large that they are wrong. The price is rounding, so other ground keeps the longer ones.

    From random starts within a basin of the chapter's eqs. (3) and (4) it takes 18 calls to 1e-13 and 2e-12 above the
    minimum; along the whole valley of eq. (2), 94 to 3e-10 (medians, 100 starts).
    """
    u, f = start, value
    if not np.isfinite(value) or _is_at_known_minimum(record, u, f, near):
        return u, f
    slope = yield from gradient(record, u, f)
    scale = float(np.abs(slope).max())
    if scale == 0.0:
        return u, f
    hessian = np.eye(len(u)) * scale / STEPS.first
    difference = STEPS.difference
    for i in range(max_steps):
        step = minimize_on_box(slope, hessian, -u, 1.0 - u)
        expected = -float(slope @ step)
        little = expected < tolerance**2 * (value - f)
        if (little and _inward(u, slope) < tolerance * scale) or expected < 1e-14 * scale:
            last = np.clip(u + step, 0.0, 1.0)
            f_last = float((yield last[None])[0])
            return (last, f_last) if f_last < f else (u, f)
        moved, f_moved, slope_moved = yield from _line_search(record, u, f, slope, step, difference, near=near)
        if slope_moved is None:
            return moved, f_moved
        if np.abs(moved - u).max() < difference:  # as good as no step: no slope is known on so short a way
            u, f = moved, f_moved
            if little or difference == STEPS.difference_at_kinks:
                break
            difference = STEPS.difference_at_kinks
            slope = yield from gradient(record, u, f, difference=difference)
            continue
        if i == 0:
            hessian = _rescale(hessian, moved - u, slope_moved - slope)
        hessian = _update_bfgs(hessian, moved - u, slope_moved - slope)
        u, f, slope = moved, f_moved, slope_moved
    return u, f


def _is_at_known_minimum(record: Record, u: Array, f: float, near: float) -> bool:
    """Return whether a known minimum that lies no higher than `f` is within `near` of `u`."""
    minima, values, _ = record.minima.sorted()
    return bool(((np.abs(minima - u).max(axis=1) < near) & (values <= f)).any())


def _line_search(
    record: Record, u: Array, f: float, slope: Array, step: Array, difference: float, *, near: float
) -> Evaluations[tuple[Array, float, Array | None]]:
    """Return the first point along `step` that meets the weak Wolfe conditions, its value and its slope.

    Enough decrease (Armijo), and a slope along the step that has risen; the latter fails on the near side of a kink,
    or where the step was too short, and is waived at a bound. If nothing meets both, the last that meets the first, or
    `u`. At a known minimum the slope is None: none was taken.
    """
    expected = -float(slope @ step)
    best: tuple[Array, float, Array | None] = u, f, slope
    low, high, reach, length = 0.0, np.inf, _reach(u, step), 1.0
    while np.isinf(high) or (high > STEPS.shortest and high - low > STEPS.bracket * high):
        moved = np.clip(u + length * step, 0.0, 1.0)
        f_moved = float((yield moved[None])[0])
        if not f_moved <= f - STEPS.sufficient * length * expected:
            high = length
            length = (low + high) / 2 if low else _shorter(length, f, f_moved, expected)
            continue
        if _is_at_known_minimum(record, moved, f_moved, near):
            return moved, f_moved, None
        slope_moved = yield from gradient(record, moved, f_moved, difference=difference)
        best = moved, f_moved, slope_moved
        if -float(slope_moved @ step) <= STEPS.risen * expected or length >= reach:
            break
        low = length
        length = min(2 * length, reach) if np.isinf(high) else (low + high) / 2
    return best


def _reach(u: Array, step: Array) -> float:
    """Return how many times the step may be taken before a bound; at least once, for it ends within them."""
    moves = step != 0.0
    bound = np.where(step > 0.0, 1.0 - u, -u)
    return max(1.0, float((bound[moves] / step[moves]).min()))


def gradient(record: Record, u: Array, value: float, *, difference: float = STEPS.difference) -> Evaluations[Array]:
    """Return forward differences (dim,), backward at the upper bound."""
    steps = np.where(u + difference <= 1.0, difference, -difference)
    moved = u + np.diag(steps)
    record.njev += 1
    values = yield moved
    slope = (values - value) / (np.diagonal(moved) - u)  # the step as the floats have it
    return np.where(np.isfinite(slope), slope, 0.0)


def _shorter(length: float, f: float, f_moved: float, expected: float) -> float:
    """Return the minimum of the parabola through the two values and the slope, within `STEPS.shortening`."""
    if not np.isfinite(f_moved):
        return STEPS.shortening[0] * length
    best = expected * length**2 / (2 * (f_moved - f + expected * length))
    least, most = STEPS.shortening
    return float(np.clip(best, least * length, most * length))


def _inward(u: Array, slope: Array) -> float:
    """Return the largest slope of those that do not push against a bound."""
    pushing = ((u <= 0.0) & (slope > 0.0)) | ((u >= 1.0) & (slope < 0.0))
    return float(np.abs(np.where(pushing, 0.0, slope)).max())


def _rescale(hessian: Array, step: Array, change: Array) -> Array:
    """Return the curvature met on the first step for every direction, if there was one; else `hessian`."""
    curvature = float(step @ change) / float(step @ step)
    return np.eye(len(step)) * curvature if curvature > 0.0 else hessian


def _update_bfgs(hessian: Array, step: Array, change: Array) -> Array:
    along = hessian @ step
    curvature = float(step @ along)
    if curvature <= 0.0:
        return hessian
    met = float(step @ change)
    theta = 1.0 if met >= 0.2 * curvature else 0.8 * curvature / (curvature - met)  # Powell 1978
    damped = theta * change + (1 - theta) * along
    updated = hessian - np.outer(along, along) / curvature + np.outer(damped, damped) / float(step @ damped)
    curvatures = np.linalg.eigvalsh(updated)
    return updated if curvatures[0] > 1e-14 * curvatures[-1] else hessian  # rounding may cost it its definiteness
