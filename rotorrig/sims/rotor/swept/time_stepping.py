"""Time stepping of a' = L a + f, a few modes from turn to turn, by exponential propagators.

The propagators of every step are computed once and then serve any number of columns (`step_modes`): loads, and the
derivatives of their responses.
"""

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@njit(cache=True)
def propagators(L: Complex, h: Reals) -> Complex:
    """Compute E, B0, B1, B2 of steps of length h, (step, 4, mode, mode), for constant L (step, mode, mode).

    a(h) = E a(0) + B0 f(0) + B1 f(h/2) + B2 f(h) is exact for a force quadratic in time: with f = p0 + p1 s + p2 s^2,
    R = L^-1 and D = (1 - E) R, integration by parts gives
    a(h) = E a(0) - D p0 - (D + h) R p1 - (2 (D + h) R + h^2) R p2.
    """
    steps, size = len(h), L.shape[1]
    out = np.empty((steps, 4, size, size), dtype=np.complex128)
    between = np.empty((4, size, size), dtype=np.complex128)
    inverse, work, by_p0, by_p1, by_p2 = np.empty((5, size, size), dtype=np.complex128)
    for k in range(steps):
        flow = out[k, 0]
        exponential(L[k], h[k], flow, between)
        invert(L[k], inverse, work)
        _with_diagonal(flow, -1.0, work)
        multiply(work, inverse, 1.0, by_p0)  # -D
        _with_diagonal(by_p0, -h[k], work)
        multiply(work, inverse, 1 / h[k], by_p1)  # per p1 h
        _with_diagonal(by_p1, -h[k] / 2, work)
        multiply(work, inverse, 2 / h[k], by_p2)  # per p2 h^2
        for i in range(size):
            for j in range(size):  # p1 h = 4 f1 - 3 f0 - f2, p2 h^2 = 2 f0 - 4 f1 + 2 f2
                out[k, 1, i, j] = by_p0[i, j] - 3 * by_p1[i, j] + 2 * by_p2[i, j]
                out[k, 2, i, j] = 4 * (by_p1[i, j] - by_p2[i, j])
                out[k, 3, i, j] = 2 * by_p2[i, j] - by_p1[i, j]
    return out


@njit(cache=True)
def step_modes(
    L: Complex, steps: Complex, phases: Complex, force: Complex, force_mid: Complex, start: Complex
) -> tuple[Complex, Complex]:
    """Step a and a' through the turns, (turn, mode, column) each, from `start` (mode, column).

    L (turn, mode, mode), `force` (turn, mode, column) and `force_mid` (step, mode, column) are in the frame of their
    own instant, `steps` as `propagators` returns them in one that turns evenly over a step: `phases` (step, 2) take
    the forces at the middle and the end there, conjugate back.
    """
    turns, size, columns = force.shape
    a = np.zeros((turns, size, columns), dtype=np.complex128)
    rate = force.copy()
    a[0] = start
    for k in range(turns):
        add_matrix(L[k], a[k], 1.0, rate[k])
        if k + 1 < turns:
            middle, end = phases[k]
            add_matrix(steps[k, 0], a[k], end.conjugate(), a[k + 1])
            add_matrix(steps[k, 1], force[k], end.conjugate(), a[k + 1])
            add_matrix(steps[k, 2], force_mid[k], end.conjugate() * middle, a[k + 1])
            add_matrix(steps[k, 3], force[k + 1], 1.0, a[k + 1])
    return a, rate


@njit(cache=True)
def add_matrix(A: Complex, x: Complex, factor: complex, y: Complex) -> None:
    """Add `factor` A x to y, x and y (row, column)."""
    for i in range(len(A)):
        for j in range(len(x)):
            entry = A[i, j] * factor
            for c in range(x.shape[1]):
                y[i, c] += entry * x[j, c]


@njit(cache=True)
def add_operator_change(
    still: Reals, turning: Reals, power: Reals, alpha: Reals, a: Complex, a_mid: Complex, force: Complex, mid: Complex
) -> None:
    """Add (dL - alpha dT) a to the forces at the turns and halfway, `force` and `mid` (turn, mode, column).

    `still` and `turning` are the coefficients of dL and dT, (power, direction mode mode), re and im in turn; a column
    is a direction and a load. Halfway the change is taken as the mean of both turns: Omega hardly moves on over one.
    """
    here, before = np.empty(still.shape[1]), np.empty(still.shape[1])
    for k in range(len(a)):
        here, before = before, here
        for i in range(len(here)):
            here[i] = 0
        for q in range(len(still)):
            for i in range(len(here)):
                here[i] += power[k, q] * (still[q, i] - alpha[k] * turning[q, i])
        _add_product(here, a[k], force[k])
        if k:
            for i in range(len(here)):
                before[i] = (before[i] + here[i]) / 2
            _add_product(before, a_mid[k - 1], mid[k - 1])


@njit(cache=True)
def _add_product(change: Reals, a: Complex, force: Complex) -> None:
    """Add matrices (direction mode mode) times a (mode, load) to `force` (mode, direction load)."""
    size, loads = a.shape
    n = 0
    for d in range(force.shape[1] // loads):
        for i in range(size):
            for j in range(size):
                entry = complex(change[n], change[n + 1])
                n += 2
                for c in range(loads):
                    force[i, d * loads + c] += entry * a[j, c]


@njit(cache=True)
def exponential(L: Complex, h: float, flow: Complex, work: Complex) -> None:
    """Put e^{L h} into `flow`: scaling and squaring of a Taylor series, the trace taken out first.

    `work` (4, row, row) is for what comes between. The series goes to the ninth power by four products (Paterson and
    Stockmeyer, SIAM J. Comput. 2 (1973) 60).
    """
    size = len(L)
    A, square, cube, term = work[0], work[1], work[2], work[3]
    mean = 0j
    for i in range(size):
        mean += L[i, i] / size
    norm = 0.0
    for i in range(size):
        row = 0.0
        for j in range(size):
            A[i, j] = (L[i, j] - (mean if i == j else 0.0)) * h
            row += abs(A[i, j].real) + abs(A[i, j].imag)
        norm = max(norm, row)
    if size == 2:  # without its trace A^2 = -det A, so e^A = cosh s + A sinh(s) / s, s^2 = -det A
        _exponential_of_pair(A, flow)
        _scale(flow, np.exp(mean * h))
        return
    halvings = max(0, math.ceil(math.log2(norm + 1e-300)) + 2)  # norm at most 1/4: (1/4)^10 / 10! = 3e-13
    _scale(A, complex(0.5**halvings))
    multiply(A, A, 1.0, square)
    multiply(A, square, 1.0, cube)
    for i in range(size):
        for j in range(size):
            term[i, j] = A[i, j] * (1 / 5040) + square[i, j] * (1 / 40320) + cube[i, j] * (1 / 362880)
        term[i, i] += 1 / 720
    multiply(cube, term, 1.0, flow)
    for i in range(size):
        for j in range(size):
            flow[i, j] += A[i, j] * (1 / 24) + square[i, j] * (1 / 120)
        flow[i, i] += 1 / 6
    multiply(cube, flow, 1.0, term)
    for i in range(size):
        for j in range(size):
            flow[i, j] = term[i, j] + A[i, j] + square[i, j] * 0.5
        flow[i, i] += 1.0
    for _ in range(halvings):
        multiply(flow, flow, 1.0, term)
        _with_diagonal(term, 0.0, flow)
    _scale(flow, np.exp(mean * h))


@njit(cache=True)
def _exponential_of_pair(A: Complex, flow: Complex) -> None:
    """Put e^A into `flow`, A (2, 2) with trace zero."""
    squared = A[0, 0] * A[0, 0] + A[0, 1] * A[1, 0]
    s = np.sqrt(squared)
    even, odd = np.cosh(s), 1 + squared / 6  # sinh(s) / s, by its series below 1e-4
    if abs(s) > 1e-4:
        odd = np.sinh(s) / s
    for i in range(2):
        for j in range(2):
            flow[i, j] = odd * A[i, j]
        flow[i, i] += even


@njit(cache=True)
def invert(A: NDArray[Any], inverse: NDArray[Any], work: NDArray[Any]) -> None:
    """Put A^-1 into `inverse`: Gauss and Jordan with row exchange; for so few rows faster than LAPACK."""
    size = len(A)
    _with_diagonal(A, 0.0, work)
    for i in range(size):
        for j in range(size):
            inverse[i, j] = 1.0 if i == j else 0.0
    for column in range(size):
        best = column
        for row in range(column + 1, size):
            if abs(work[row, column]) > abs(work[best, column]):
                best = row
        for j in range(size):
            work[column, j], work[best, j] = work[best, j], work[column, j]
            inverse[column, j], inverse[best, j] = inverse[best, j], inverse[column, j]
        scale = 1 / work[column, column]
        for j in range(size):
            work[column, j] *= scale
            inverse[column, j] *= scale
        for row in range(size):
            if row != column:
                factor = work[row, column]
                for j in range(size):
                    work[row, j] -= factor * work[column, j]
                    inverse[row, j] -= factor * inverse[column, j]


@njit(cache=True)
def _with_diagonal(A: NDArray[Any], added: float, B: NDArray[Any]) -> None:
    """Put A + added into B."""
    for i in range(len(A)):
        for j in range(len(A)):
            B[i, j] = A[i, j]
        B[i, i] += added


@njit(cache=True)
def _scale(A: Complex, factor: complex) -> None:
    """Multiply A by a factor in place."""
    for i in range(len(A)):
        for j in range(len(A)):
            A[i, j] *= factor


@njit(cache=True)
def multiply(A: Complex, B: Complex, factor: float, C: Complex) -> None:
    """Put A B times a factor into C."""
    for i in range(len(A)):
        for j in range(len(A)):
            total = 0j
            for k in range(len(A)):
                total += A[i, k] * B[k, j]
            C[i, j] = total * factor


#: weights of the force at the end, at the start and at the two turns before, in that halfway: a cubic, a straight line
SMOOTH = (5 / 16, 15 / 16, -5 / 16, 1 / 16)
STRAIGHT = (0.5, 0.5, 0.0, 0.0)
