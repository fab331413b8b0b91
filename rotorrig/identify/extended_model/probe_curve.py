"""Curvature of a probe's scale, a nuisance of every fit: for a motion r it reads r (1 + a r + b r^2 + c r^3 + d r^4).

r is counted in units of `CURVED_AT`, so that a coefficient is the share by which the scale is off there. Up to 400 um
four of them follow a calibration table with straight lines between its points to 2 % of what it bends, two to 10 %.
"""

from math import comb

import numpy as np
from numpy.typing import NDArray

CURVED_AT = 300e-6  # m, 0-peak
POWERS = (2, 3, 4, 5)  # of r


def curve_names(probes: tuple[str, ...]) -> list[str]:
    """Return the coefficients, all probes' of one power after those of another."""
    return [f"curvature {probe} r^{power}" for power in POWERS for probe in probes]


def bend(first: NDArray[np.complex128], order: int, power: int) -> NDArray[np.complex128]:
    """Return the n-th order [m] of r^power, r = Re(first e^{j theta}) in units of CURVED_AT.

    >>> print(bend(np.array([3e-4 + 0j]), 2, 2))  # cos^2 = 1/2 + 1/2 cos 2 theta
    [0.00015+0.j]
    """
    left = _left(order, power)
    if left is None:
        return np.zeros_like(first)
    r = first / CURVED_AT
    return CURVED_AT * _share(left, power) * np.abs(r) ** (2 * left) * r**order


def bend_slopes(first: NDArray[np.complex128], order: int, power: int) -> NDArray[np.complex128]:
    """Return how `bend` goes with a change of `first`, and with that change's conjugate, (2, ...).

    >>> along, mirrored = bend_slopes(np.array([3e-4 + 0j]), 1, 3)  # 3/4 |r|^2 r
    >>> print(along, mirrored)
    [1.5+0.j] [0.75+0.j]
    """
    left = _left(order, power)
    if left is None:
        return np.zeros((2, *first.shape), complex)
    r = first / CURVED_AT
    square, share = np.abs(r) ** 2, _share(left, power)
    mirrored = left * square ** (left - 1) * r ** (order + 1) if left else np.zeros_like(r)
    return share * np.stack([(left + order) * square**left * r ** (order - 1), mirrored])


def _left(order: int, power: int) -> int | None:
    """Return by how many pairs of factors r^power holds the order; None if it holds none of it."""
    left, odd = divmod(power - order, 2)
    return None if odd or left < 0 else left


def _share(left: int, power: int) -> float:
    """Return the share of the order in r^power."""
    return 2.0 ** (1 - power) * comb(power, left)
