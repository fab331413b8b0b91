"""Curvature of what a probe reads, a nuisance of every fit: for a motion r, r (1 + a r + b r^2 + c r^3 + d r^4).

r is counted in units of `CURVED_AT`, so that a coefficient is the share by which the scale is off there. Up to 400 um
four of them follow a calibration table with straight lines between its points to 2 % of what it bends, two to 10 %.

The motion s across the probe, which another of its plane reads, counts too (API 670 warns of shafts as thin as a rotor
kit's): the surface curves away from the tip, by s^2 / diameter, and the field that a neighbour or the shaft's flank
takes of the tip's depends on both gaps, which leaves r s. Either shows at 2X.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.processing import measured_planes
from rotorrig.rig.config import RigConfig

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

CURVED_AT = 300e-6  # m, 0-peak
POWERS = (2, 3, 4, 5)  # of r
ACROSS = ("r s", "s^2")  # products with the reading of the other probe of its plane


class ProbeCurves:
    """Coefficients of all probes: of one power of r after those of another, then of the products with s."""

    def __init__(self, rig: RigConfig, probes: Sequence[str]) -> None:
        """Lay out those of `probes`; one that is alone in its plane has none with s."""
        pairs = [pair for _, pair in measured_planes(rig, probes)]
        across = dict(sorted(both for i, j in pairs for both in ((i, j), (j, i))))
        powers = [(probe, power) for power in POWERS for probe in range(len(probes))]
        #: (coefficient, 3): of a product, the probe that reads it and the two whose readings it is of
        products = [*((i, i, s) for i, s in across.items()), *((i, s, s) for i, s in across.items())]
        self._products = np.array(products, int).reshape(-1, 3)
        self._powers = len(powers)
        self.probe = np.array([i for i, _ in powers] + [i for i, _, _ in self._products], int)  # (coefficient,)
        self.names = [f"curvature {probes[i]} r^{power}" for i, power in powers]
        self.names += [f"curvature {probes[i]} {of}" for of in ACROSS for i in across]
        sigmas = (rig.prior.probe_linearity, EXTENDED_MODEL.roundness * CURVED_AT / rig.shaft.diameter)
        self.prior_sigma = np.repeat(sigmas, (self._powers, len(self._products)))

    def columns(self, first: Complex, order: int) -> Complex:
        """Return what a unit of every coefficient adds to its probe, (row + 1, coefficient) [m], of 1X vectors."""
        powers = [bend(first, order, power) for power in POWERS]
        r, s = first[:, self._products[:, 1]], first[:, self._products[:, 2]]
        return np.concatenate([*powers, _bend_product(r, s, order)], axis=1)

    def bend(self, shares: Reals, first: Complex, order: int) -> Complex:
        """Return what the coefficients `shares` add to an order, (row + 1, probe) [m], of 1X vectors `first`."""
        found = np.zeros_like(first)
        np.add.at(found.T, self.probe, (shares * self.columns(first, order)).T)
        return found

    def changes(self, shares: Reals, first: Complex, changes: Complex, order: int) -> Complex:
        """Return how `bend` goes with small changes of the 1X vectors, (row + 1, probe, column)."""
        if not shares.any():
            return np.zeros_like(changes)
        own = shares[: self._powers].reshape(len(POWERS), -1)
        slopes = [share * bend_slopes(first, order, power) for power, share in zip(POWERS, own, strict=True)]
        along, mirrored = np.sum(slopes, axis=0)[..., None]
        found = along * changes + mirrored * changes.conj()
        if order != 2:
            return found
        for share, (probe, r, s) in zip(shares[self._powers :], self._products, strict=True):
            by_r = _bend_product(first[:, s, None], changes[:, r], order)
            found[:, probe] += share * (by_r + _bend_product(first[:, r, None], changes[:, s], order))
        return found


def _bend_product(r: Complex, s: Complex, order: int) -> Complex:
    """Return the n-th order [m] of the product r s of two 1X vectors [m], counted as `bend` does: 2X alone."""
    return r * s / (2 * CURVED_AT) if order == 2 else np.zeros(np.broadcast_shapes(r.shape, s.shape), complex)


def bend(first: Complex, order: int, power: int) -> Complex:
    """Return the n-th order [m] of r^power, r = Re(first e^{j theta}) in units of CURVED_AT.

    >>> print(bend(np.array([3e-4 + 0j]), 2, 2))  # cos^2 = 1/2 + 1/2 cos 2 theta
    [0.00015+0.j]
    """
    left = _left(order, power)
    if left is None:
        return np.zeros_like(first)
    r = first / CURVED_AT
    return CURVED_AT * _share(left, power) * np.abs(r) ** (2 * left) * r**order


def bend_slopes(first: Complex, order: int, power: int) -> Complex:
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
    return 2.0 ** (1 - power) * math.comb(power, left)
