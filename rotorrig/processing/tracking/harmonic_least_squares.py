"""Harmonic least squares on the known angle: all orders asked for, their neighbours and the mean at once, row by row.

A row of `turns` turns about its middle angle is taken as

    x = sum_n Re((a_n + b_n psi) e^{j n psi}) + rest,   weighted by 1 + cos(psi / turns) per angle,

over the orders asked for and the whole ones up to one above the highest, order 0 among them; z_n is a_n, turned back
from the middle angle. In a fit, orders need not be three bins of 1 / turns apart, as in the DFT, but one
(`settings.ORDER_SEPARATION`): an order tracked with its neighbours takes a third of the turns. The slopes b_n keep an
amplitude that changes through the row from leaking into its neighbours. A parabola in the amplitude is seen as under
the Hann window alone, the fit being symmetric in psi: the same smear, as long as two Hann bins separate the orders.

Björck, Numerical Methods for Least Squares Problems (1996), ch. 2.2: normal equations, here of a few well separated
functions whose condition number stays below 2e4.
"""

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.processing.rows import Rows
from rotorrig.processing.shaft_angle import TURN, ShaftAngle
from rotorrig.processing.tracking.row_samples import samples_by_row
from rotorrig.processing.waveform import Waveforms

SINGULAR = 1e-12  # of the largest singular value

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]


def track(
    waveforms: Waveforms,
    shaft: ShaftAngle,
    rows: Rows,
    *,
    orders: tuple[float, ...],
    progress: Callable[[float], None] | None = None,
) -> Complex:
    """Return z (row, probe, order) [m, 0-peak]; NaN where samples are missing. `progress` gets the fraction done."""
    z = np.full((len(rows.t), waveforms.probes, len(orders)), np.nan, dtype=complex)
    for i, (x, psi, omega) in samples_by_row(waveforms, shaft, rows, progress):
        z[i] = order_vectors(x, psi, omega, orders=orders, turns=rows.turns)
    return z * np.exp(-1j * TURN * np.outer(rows.middle, orders))[:, None]


def order_vectors(x: Reals, psi: Reals, omega: Reals, *, orders: tuple[float, ...], turns: int) -> Complex:
    """Return a_n (probe, order) of one row: `x` (sample, probe) at angles `psi` [rad] from the row's middle.

    `omega` (sample,) is the speed, which makes d(psi) of equal steps in time.
    """
    fitted = fitted_orders(orders)
    reference = x[:1].copy()
    matrix, right = _normal_equations(np.ascontiguousarray(x - reference), psi, omega, np.array(fitted), float(turns))
    # (probe, function): two of order 0, four of every other; samples too few to tell them apart give the least of all
    coefficients = np.linalg.lstsq(matrix, right, rcond=SINGULAR)[0].T
    z = np.empty((x.shape[1], len(orders)), dtype=complex)
    for k, order in enumerate(orders):
        at = 4 * fitted.index(abs(order)) - 2
        pair = coefficients[:, at] - 1j * coefficients[:, at + 1] if order else coefficients[:, 0] + reference[0]
        z[:, k] = pair.conj() if order < 0 else pair
    return z


def fitted_orders(orders: tuple[float, ...]) -> tuple[float, ...]:
    """Return the orders that are fitted at once: those asked for, and the whole ones to one above the highest.

    >>> fitted_orders((1.0, 0.47))
    (0.0, 0.47, 1.0, 2.0)
    """
    sizes = [abs(order) for order in orders]
    return tuple(sorted({*sizes, *map(float, range(math.floor(max(sizes)) + 2))}))


def noise_response(offset: Reals, *, order: float, orders: tuple[float, ...], turns: int) -> Reals:
    """Return |H|^2 at `offset` = (orders from the one tracked) * turns, 1 at 0 and 0 at every other order of the fit.

    In closed form: with many samples per turn the normal equations are Hann's transform and its derivatives.
    """
    fitted = fitted_orders(orders)
    signed = np.array([*(-o for o in fitted[:0:-1]), *fitted])
    at, power = np.tile(signed, 2), np.repeat([0, 1], len(signed))  # the constants, then the slopes
    matrix = _hann_moment((at[None, :] - at[:, None]) * turns, power[:, None] + power[None, :])
    mine = int(np.argmin(np.abs(signed - abs(order))))
    weights = np.linalg.solve(matrix, np.eye(len(at))[mine])  # that column of the inverse, a Hermitian matrix
    seen = _hann_moment(offset[:, None] + (abs(order) - at[None, :]) * turns, power[None, :])
    return np.abs(seen @ weights.conj()) ** 2


def _hann_moment(x: Reals, power: NDArray[np.intp]) -> Complex:
    """Return the mean of s^power e^{j pi s x} over |s| < 1 under 1 + cos(pi s), for powers 0, 1 and 2.

    s = psi / (pi turns) and x = orders apart times turns. Power 0 is Hann's transform, the others its derivatives.
    """
    each = zip(_sinc(x), _sinc(x + 1), _sinc(x - 1), strict=True)
    sums = [middle + (above + below) / 2 for middle, above, below in each]
    return np.choose(power, [sums[0] + 0j, sums[1] / (1j * np.pi), -sums[2] / np.pi**2])


def _sinc(x: Reals) -> tuple[Reals, Reals, Reals]:
    """Return sin(pi x) / (pi x) and its first two derivatives."""
    small = np.abs(x) < 1e-4
    safe = np.where(small, 1.0, x)
    value = np.sinc(x)
    slope = np.where(small, -(np.pi**2) * x / 3, (np.cos(np.pi * safe) - np.sinc(safe)) / safe)
    curvature = np.where(small, -(np.pi**2) / 3, -(np.pi**2) * value - 2 * slope / safe)
    return value, slope, curvature


@njit(cache=True, error_model="numpy")
def _normal_equations(x: Reals, psi: Reals, omega: Reals, fitted: Reals, turns: float) -> tuple[Reals, Reals]:
    """Return the normal matrix (function, function) and right-hand sides (function, probe).

    The functions are 1, s, then cos, sin, s cos, s sin of each order, `fitted` of which the first is 0.
    """
    samples, probes = x.shape
    size = 4 * len(fitted) - 2
    matrix, right, f = np.zeros((size, size)), np.zeros((size, probes)), np.empty(size)
    for i in range(samples):
        weight = (1 + np.cos(psi[i] / turns)) * omega[i]
        s = psi[i] / (np.pi * turns)
        f[0], f[1] = 1.0, s
        for n in range(1, len(fitted)):
            cosine, sine = np.cos(fitted[n] * psi[i]), np.sin(fitted[n] * psi[i])
            f[4 * n - 2], f[4 * n - 1], f[4 * n], f[4 * n + 1] = cosine, sine, s * cosine, s * sine
        for a in range(size):
            weighted = weight * f[a]
            for b in range(a + 1):
                matrix[a, b] += weighted * f[b]
            for p in range(probes):
                right[a, p] += weighted * x[i, p]
    for a in range(size):
        for b in range(a):
            matrix[b, a] = matrix[a, b]
    return matrix, right
