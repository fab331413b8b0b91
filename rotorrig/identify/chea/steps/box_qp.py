"""The least value of a quadratic within a box, by an active set: the step of a trust region."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.steps.settings import STEPS

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-14  # a gain, of what the first slope would give over the whole box


def minimize_on_box(gradient: Array, hessian: Array, low: Array, high: Array) -> Array:
    """Return a step s (dim,) that is a local minimum of g s + s H s / 2 within low <= 0 <= high.

    From s = 0, Newton steps in the parameters that are free, each to the minimum on its line or to the first bound in
    its way, which then holds. Where no step gains any more, the bound with the steepest slope inwards is let go. H may
    be indefinite; the value never rises.

    >>> minimize_on_box(np.array([-1.0, -4.0]), np.eye(2), np.full(2, -2.0), np.full(2, 2.0)).tolist()
    [1.0, 2.0]
    """
    s = np.zeros(len(gradient))
    held = np.where(gradient > 0, low >= 0, high <= 0)
    negligible = NEGLIGIBLE * float(np.abs(gradient) @ (high - low))
    for _ in range(STEPS.passes * len(s)):
        slope = gradient + hessian @ s
        direction = _newton(slope, hessian, np.flatnonzero(~held))
        if -float(slope @ direction) > negligible:
            s, met = _along(direction, s, slope, hessian, low, high)
            if met >= 0:
                held[met] = True
            continue
        inwards = np.where(held, np.where(s <= low, -slope, slope) * (high - low), 0.0)
        if not (inwards > negligible).any():
            break
        held[inwards.argmax()] = False
    return s


def _newton(slope: Array, hessian: Array, free: NDArray[np.intp]) -> Array:
    """Return the Newton direction in the free parameters with the curvatures' absolute values: downhill in any case."""
    direction = np.zeros(len(slope))
    if len(free):
        curvatures, axes = np.linalg.eigh(hessian[free[:, None], free])
        sizes = np.abs(curvatures)
        floor = 1e-12 * sizes.max() + np.finfo(np.float64).tiny
        direction[free] = -axes @ ((axes.T @ slope[free]) / np.maximum(sizes, floor))
    return direction


def _along(direction: Array, s: Array, slope: Array, hessian: Array, low: Array, high: Array) -> tuple[Array, int]:
    """Return the least point on the line from s along the direction, and which bound was met there, or -1."""
    bound = np.where(direction > 0, high, low)
    moves = np.flatnonzero(direction)
    lengths = (bound[moves] - s[moves]) / direction[moves]
    first = int(lengths.argmin())
    curvature = float(direction @ hessian @ direction)
    if curvature > 0 and -float(slope @ direction) < lengths[first] * curvature:
        return np.clip(s - float(slope @ direction) / curvature * direction, low, high), -1
    s = np.clip(s + lengths[first] * direction, low, high)
    s[moves[first]] = bound[moves[first]]
    return s, int(moves[first])
