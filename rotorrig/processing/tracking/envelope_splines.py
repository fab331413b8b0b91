"""Envelopes of several orders as cubic splines in shaft angle, smooth by a penalty on their curvature.

x(theta) = Re sum_n A_n(theta) e^{j n theta} + rest, A_n = sum_i c_ni B_i, B_i the B-splines of equally spaced knots:

    minimise  integral (x - Re sum_n A_n e^{j n theta})^2 + sum_n lambda_n integral |A_n''|^2,

a system of linear equations whose band is as wide as four knots times two per order. The unknowns are d_ni = c_ni e^{j
n theta_i} with theta_i the angle of knot i: told from its own knot each function looks alike, so that one matrix per
cell between knots serves all cells. Eilers & Marx, Statistical Science 11 (1996) 89: splines with a penalty.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded

TURN = 2 * np.pi
SPAN = 4  # functions over each cell
#: of 1, s, s^2, s^3 in the four functions over a cell, 0 <= s < 1
_CUBIC = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvelopeSplines:
    """The equations of some orders at some spacing of the knots. Cell c lies between the knots c and c + 1."""

    orders: Reals  # (order,) none twice, none below 0
    knot: float  # turns between knots
    cell: Reals  # (4 unknown, 4 unknown) what a cell with samples adds; unknowns (order, re and im)

    @classmethod
    def of(cls, orders: tuple[float, ...], *, knot: float, cutoff: float) -> Self:
        """Return them for a filter that lets the part 1 / (1 + (f / cutoff)^4) of f orders beside its own pass."""
        return cls(orders=np.array(orders), knot=knot, cell=_cell(np.array(orders), knot, cutoff))

    def add_moments(self, moments: Reals, turn: Reals, weight: Reals, x: Reals, *, cells: tuple[int, int]) -> None:
        """Add the samples' part to `moments`, the right-hand side (function, probe, order, 2) of the `cells` from, to.

        `turn` (sample,) is where they are, `weight` (sample,) how much of a turn each stands for, `x` (sample, probe).
        Those outside the cells do not count.
        """
        _add_moments(moments, turn / self.knot - cells[0], weight, TURN * turn, self.orders, np.ascontiguousarray(x))

    def solve(self, moments: Reals, *, first: int) -> Complex:
        """Return the splines' coefficients c (function, probe, order) from moments whose first cell is `first`."""
        functions, probes, orders, _ = moments.shape
        carried = self._carrier(first, functions)[:, None]
        d = (moments[..., 0] + 1j * moments[..., 1]) * carried
        right = np.stack([d.real, d.imag], axis=-1).transpose(0, 2, 3, 1).reshape(-1, probes)
        band = cholesky_banded(
            self._band_matrix(functions - SPAN + 1), lower=True, overwrite_ab=True, check_finite=False
        )
        solution = cho_solve_banded((band, True), right, overwrite_b=True, check_finite=False)
        pairs = solution.reshape(functions, orders, 2, probes)
        return (pairs[:, :, 0] + 1j * pairs[:, :, 1]).swapaxes(1, 2) * carried.conj()

    def at(self, coefficients: Complex, turn: Reals, *, first: int) -> Complex:
        """Return the envelopes (point, probe, order) at `turn` (point,); the coefficients' first cell is `first`."""
        place = turn / self.knot
        cell = np.clip(np.floor(place).astype(np.intp), first, first + len(coefficients) - SPAN)
        by = _basis(place - cell)
        return np.einsum("rb,rbpk->rpk", by, coefficients[(cell - first)[:, None] + np.arange(SPAN)])

    def _carrier(self, first: int, functions: int) -> Complex:
        """Return e^{j n theta_i} (function, order) at the first knot under each function."""
        return np.exp(1j * TURN * self.knot * np.outer(first + np.arange(functions), self.orders))

    def _band_matrix(self, cells: int) -> Reals:
        """Return the equations of so many cells, lower band form."""
        size = len(self.cell)
        step = size // SPAN
        band = np.zeros((size, (cells + SPAN - 1) * step))
        for column in range(size):
            for row in range(column, size):
                band[row - column, column : column + cells * step : step] += self.cell[row, column]
        return band


def _cell(orders: Reals, knot: float, cutoff: float) -> Reals:
    """Return what the integrals over one cell add to the equations, (function, order, 2) by the same, as a matrix.

    Half of the power of an envelope is in x, so 2 lambda (2 pi cutoff)^4 = 1; of order 0 all of it. The imaginary part
    of order 0, which is nowhere in x, is held at zero.
    """
    waves = 2 * knot * float(orders.max())  # of the highest product within a cell
    node, share = np.polynomial.legendre.leggauss(16 + math.ceil(8 * waves))
    s, share = (node + 1) / 2, share[:, None] * knot / 2
    value = _basis(s)
    bend = np.stack([np.full_like(s, 2), 6 * s], axis=1) @ _CUBIC[:, 2:].T / knot**2
    function = np.arange(SPAN)
    angle = TURN * knot * (s[:, None] - function)[..., None] * orders
    wave = (value[..., None, None] * np.stack([np.cos(angle), -np.sin(angle)], axis=-1)).reshape(len(s), -1)
    matrix = (wave.T @ (share * wave)).reshape(2 * (SPAN, len(orders), 2))
    curvature = bend.T @ (share * bend) / (2 * (TURN * cutoff) ** 4)
    for n, order in enumerate(orders):
        carried = curvature * np.exp(1j * TURN * knot * order * (function[:, None] - function))
        block = matrix[:, n, :, :, n, :]
        block[:, 0, :, 0] += carried.real
        block[:, 1, :, 1] += carried.real
        block[:, 0, :, 1] -= carried.imag
        block[:, 1, :, 0] += carried.imag
        if order == 0:
            block[:, 0, :, 0] += carried.real
            block[:, 1, :, 1] += value.T @ (share * value)
    return matrix.reshape(wave.shape[1], -1)


@njit(cache=True, error_model="numpy")
def _add_moments(moments: Reals, place: Reals, weight: Reals, theta: Reals, orders: Reals, x: Reals) -> None:
    """Add weight B x e^{-j n theta} of every sample to the four functions B about its `place`, in cells."""
    functions, probes, _, _ = moments.shape
    value = np.empty(SPAN)
    for i in range(len(place)):
        cell = int(np.floor(place[i]))
        if not 0 <= cell <= functions - SPAN:
            continue
        s = place[i] - cell
        value[0], value[3] = (1 - s) ** 3 / 6, s**3 / 6
        value[1], value[2] = 2 / 3 - s**2 * (1 - s / 2), 2 / 3 - (1 - s) ** 2 * (1 + s) / 2
        for n in range(len(orders)):
            cosine, sine = np.cos(orders[n] * theta[i]) * weight[i], np.sin(orders[n] * theta[i]) * weight[i]
            for b in range(SPAN):
                real, imaginary = value[b] * cosine, -value[b] * sine
                for p in range(probes):
                    moments[cell + b, p, n, 0] += real * x[i, p]
                    moments[cell + b, p, n, 1] += imaginary * x[i, p]


def _basis(s: Reals) -> Reals:
    """Return the four functions over a cell at 0 <= s < 1, (point, function)."""
    return np.vander(s, SPAN, increasing=True) @ _CUBIC.T
