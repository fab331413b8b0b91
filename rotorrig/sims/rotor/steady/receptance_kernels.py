"""The compiled part of receptance.py: a small solve per speed and candidate; speeds are innermost and go in step.

With D = K - d0 + j Omega C of the bearings that change, their reference d0 and the receptances H at the bearings (b),
the probes (p) and from the loads (f) of amounts u:

    (I + D H_bb) r = D H_bf u,    z = H_pf u - H_pb r        r: what the bearings pull more than the reference would

and with w^T = H_pb (I + D H_bb)^-1 and the bearings' motion q = H_bf u - H_bb r:

    dz/dD_ij = -w_i q_j,    dz/dK = dz/dD,    dz/dC = j Omega dz/dD,    dz/du = H_pf - w^T D H_bf

All H stand in one array (2, row, column, speed): real and imaginary parts apart, since compilers turn such loops into
vector instructions and complex ones not; rows are x and y of each bearing, then the probes; columns x and y of each
bearing [m/N], then the loads [m per unit]. Sums may be reassociated; NaN and infinity keep their meaning. No pivoting:
at the damped reference every leading part of I + D H_bb is that of a rotor held by the remaining bearings, and that
one has no resonance on the axis of real speeds. All in one file: numba's cache of a function does not see changes to
what it calls in another.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Integer = NDArray[np.int64]

COEFFICIENTS = 8  # of a group of bearings: kxx, kxy, kyx, kyy, cxx, cxy, cyx, cyy
F1, F2, F3 = 1, 2, 3  # the chapter's objectives, eq. (14) to (16)
SINGULAR = 1e20  # 1 / |pivot|^2: a pivot below 1e-10 is rounding, since the receptances are good to about ten digits

_njit = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz"})


class _Work(NamedTuple):
    """Room for one candidate; b = 2 x bearings."""

    d: Real  # (2, b, 2, speed) N/m, the rows of D's blocks
    B: Real  # (2, b, b, speed) I + D H_bb, then its factors
    r: Real  # (2, b, speed) N
    x: Real  # (2, row, speed) m: at the bearings without, at the probes with their reaction


@_njit
def answer(
    H: Real, omega: Real, group: Integer, reference: complex, coefficients: Real, amounts: Complex, out: Complex
) -> int:
    """Write the response of every candidate, (candidate, speed, probe); return the first unusable one, or -1.

    `group` (bearing,) says which coefficients a bearing has; `coefficients` (candidate, group, 8) in the order of
    COEFFICIENTS, `amounts` (candidate, load).
    """
    work = _room(H, group)
    first = 2 * len(group)
    for n in range(len(out)):
        check = _solve(H, omega, group, reference, coefficients[n], amounts[n], work)
        for p in range(out.shape[2]):
            for s in range(out.shape[1]):
                out[n, s, p] = complex(work.x[0, first + p, s], work.x[1, first + p, s])
        if not check < SINGULAR:
            return n
    return -1


@_njit
def misfit(
    H: Real,
    omega: Real,
    group: Integer,
    reference: complex,
    coefficients: Real,
    amounts: Complex,
    measured: Real,
    slow_roll: bool,
    objective: int,
    out: Real,
) -> int:
    """Write an objective of eq. (14) to (16) per candidate, (candidate,); return the first unusable one, or -1.

    `measured` (probe, speed) m, 0-peak; NaN is left out. With `slow_roll` the last speed is the slow roll, whose vector
    is subtracted from the others; `measured` has no column for it.
    """
    work = _room(H, group)
    product = np.empty(measured.shape[1])
    first = 2 * len(group)
    for n in range(len(out)):
        check = _solve(H, omega, group, reference, coefficients[n], amounts[n], work)
        if slow_roll:
            _subtract_last(work.x)
        if objective == F2:
            out[n] = _log_distance(work.x, first, measured, product)
        else:
            out[n] = _distance(work.x, first, measured, objective)
        if not check < SINGULAR:
            return n
    return -1


@_njit
def answer_and_derivatives(
    H: Real,
    omega: Real,
    group: Integer,
    reference: complex,
    coefficients: Real,
    amounts: Complex,
    out: Complex,
    by_coefficient: Complex,
    by_amount: Complex,
) -> int:
    """Write the response (probe, speed) of one candidate and its derivatives; return 0 if unusable, or -1.

    `by_coefficient` (group, 8, probe, speed), `by_amount` (load, probe, speed).
    """
    work = _room(H, group)
    check = _solve(H, omega, group, reference, coefficients, amounts, work)
    first, speeds = 2 * len(group), len(omega)
    _take_reactions(H, work.r, work.x, 0, first)  # now these rows are the bearings' motion q
    direct = _direct_loads(H, work.d, len(amounts))
    w = np.empty((2, first, speeds))
    row = np.empty((2, speeds))
    for p in range(len(out)):
        for i in range(first):
            for s in range(speeds):
                w[0, i, s], w[1, i, s] = H[0, first + p, i, s], H[1, first + p, i, s]
        _solve_transposed(work.B, w)
        for s in range(speeds):
            out[p, s] = complex(work.x[0, first + p, s], work.x[1, first + p, s])
        _by_coefficient(omega, group, w, work.x, p, row, by_coefficient)
        _by_amount(H, w, direct, p, row, by_amount)
    return -1 if check < SINGULAR else 0


@_njit
def _room(H: Real, group: Integer) -> _Work:
    size, rows, speeds = 2 * len(group), H.shape[1], H.shape[3]
    return _Work(
        np.empty((2, size, 2, speeds)),
        np.empty((2, size, size, speeds)),
        np.empty((2, size, speeds)),
        np.empty((2, rows, speeds)),
    )


@_njit
def _solve(
    H: Real, omega: Real, group: Integer, reference: complex, coefficients: Real, amounts: Complex, work: _Work
) -> float:
    """Fill `work` for one candidate; return NaN or more than SINGULAR if the candidate has no answer."""
    check = _change(omega, group, reference, coefficients, work.d)
    for amount in amounts:
        check += abs(amount)
    _apply_loads(H, amounts, work.x)
    _pull(work.d, work.x, work.r)
    _system(H, work.d, work.B)
    check += _factor(work.B)
    _forward_and_back(work.B, work.r)
    _take_reactions(H, work.r, work.x, len(work.r[0]), len(work.x[0]))
    return check


@_njit
def _change(omega: Real, group: Integer, reference: complex, coefficients: Real, d: Real) -> float:
    """Write D, row i of its block i // 2; return NaN on a negative direct coefficient, else 0."""
    check = 0.0
    for i in range(d.shape[1]):
        values = coefficients[group[i // 2]]
        for j in range(2):
            k, c = values[2 * (i % 2) + j], values[4 + 2 * (i % 2) + j]
            on = 1.0 if j == i % 2 else 0.0
            if on and (k < 0 or c < 0):
                check = np.nan
            for s in range(len(omega)):
                d[0, i, j, s] = k - on * reference.real
                d[1, i, j, s] = c * omega[s] - on * reference.imag
    return check


@_njit
def _apply_loads(H: Real, amounts: Complex, x: Real) -> None:
    """Write x = H_f u, all rows."""
    first = H.shape[2] - len(amounts)
    for i in range(x.shape[1]):
        re, im = amounts[0].real, amounts[0].imag
        for s in range(x.shape[2]):
            x[0, i, s] = H[0, i, first, s] * re - H[1, i, first, s] * im
            x[1, i, s] = H[0, i, first, s] * im + H[1, i, first, s] * re
        for f in range(1, len(amounts)):
            re, im = amounts[f].real, amounts[f].imag
            for s in range(x.shape[2]):
                x[0, i, s] += H[0, i, first + f, s] * re - H[1, i, first + f, s] * im
                x[1, i, s] += H[0, i, first + f, s] * im + H[1, i, first + f, s] * re


@_njit
def _pull(d: Real, q: Real, r: Real) -> None:
    """Write r = D q, block by block."""
    for i in range(r.shape[1]):
        x = i - i % 2
        for s in range(r.shape[2]):
            a, b, e, f = d[0, i, 0, s], d[1, i, 0, s], d[0, i, 1, s], d[1, i, 1, s]
            xr, xi, yr, yi = q[0, x, s], q[1, x, s], q[0, x + 1, s], q[1, x + 1, s]
            r[0, i, s] = a * xr - b * xi + e * yr - f * yi
            r[1, i, s] = a * xi + b * xr + e * yi + f * yr


@_njit
def _system(H: Real, d: Real, B: Real) -> None:
    """Write B = I + D H_bb."""
    for i in range(B.shape[1]):
        x = i - i % 2
        for j in range(B.shape[2]):
            on = 1.0 if i == j else 0.0
            for s in range(B.shape[3]):
                a, b, e, f = d[0, i, 0, s], d[1, i, 0, s], d[0, i, 1, s], d[1, i, 1, s]
                xr, xi, yr, yi = H[0, x, j, s], H[1, x, j, s], H[0, x + 1, j, s], H[1, x + 1, j, s]
                B[0, i, j, s] = on + a * xr - b * xi + e * yr - f * yi
                B[1, i, j, s] = a * xi + b * xr + e * yi + f * yr


@_njit
def _factor(B: Real) -> float:
    """Make B into its factors L U, with 1 / diagonal of U on the diagonal; return the sum of that magnitude squared."""
    total = 0.0
    size, speeds = B.shape[1], B.shape[3]
    for k in range(size):
        for s in range(speeds):
            re, im = B[0, k, k, s], B[1, k, k, s]
            scale = 1.0 / (re * re + im * im)
            B[0, k, k, s], B[1, k, k, s] = re * scale, -im * scale
            total += scale
        for i in range(k + 1, size):
            for s in range(speeds):
                re, im = B[0, i, k, s], B[1, i, k, s]
                a, b = B[0, k, k, s], B[1, k, k, s]
                B[0, i, k, s], B[1, i, k, s] = re * a - im * b, re * b + im * a
            for j in range(k + 1, size):
                for s in range(speeds):
                    a, b, re, im = B[0, i, k, s], B[1, i, k, s], B[0, k, j, s], B[1, k, j, s]
                    B[0, i, j, s] -= a * re - b * im
                    B[1, i, j, s] -= a * im + b * re
    return total


@_njit
def _forward_and_back(B: Real, r: Real) -> None:
    """Make r into B^-1 r in place, from the factors."""
    size = r.shape[1]
    for i in range(1, size):
        for j in range(i):
            _less(B, i, j, r)
    for i in range(size - 1, -1, -1):
        for j in range(i + 1, size):
            _less(B, i, j, r)
        _times_diagonal(B, i, r)


@_njit
def _solve_transposed(B: Real, w: Real) -> None:
    """Make w into B^-T w in place, from the factors."""
    size = w.shape[1]
    for i in range(size):
        for j in range(i):
            _less_transposed(B, i, j, w)
        _times_diagonal(B, i, w)
    for i in range(size - 2, -1, -1):
        for j in range(i + 1, size):
            _less_transposed(B, i, j, w)


@_njit
def _less(B: Real, i: int, j: int, r: Real) -> None:
    for s in range(r.shape[2]):
        a, b = B[0, i, j, s], B[1, i, j, s]
        r[0, i, s] -= a * r[0, j, s] - b * r[1, j, s]
        r[1, i, s] -= a * r[1, j, s] + b * r[0, j, s]


@_njit
def _less_transposed(B: Real, i: int, j: int, r: Real) -> None:
    for s in range(r.shape[2]):
        a, b = B[0, j, i, s], B[1, j, i, s]
        r[0, i, s] -= a * r[0, j, s] - b * r[1, j, s]
        r[1, i, s] -= a * r[1, j, s] + b * r[0, j, s]


@_njit
def _times_diagonal(B: Real, i: int, r: Real) -> None:
    for s in range(r.shape[2]):
        a, b = B[0, i, i, s], B[1, i, i, s]
        r[0, i, s], r[1, i, s] = a * r[0, i, s] - b * r[1, i, s], a * r[1, i, s] + b * r[0, i, s]


@_njit
def _take_reactions(H: Real, r: Real, x: Real, first: int, last: int) -> None:
    """Subtract H_b r from x, rows `first` to `last`."""
    for i in range(first, last):
        for b in range(r.shape[1]):
            for s in range(x.shape[2]):
                x[0, i, s] -= H[0, i, b, s] * r[0, b, s] - H[1, i, b, s] * r[1, b, s]
                x[1, i, s] -= H[0, i, b, s] * r[1, b, s] + H[1, i, b, s] * r[0, b, s]


@_njit
def _direct_loads(H: Real, d: Real, loads: int) -> Real:
    """Return D H_bf, (2, b, load, speed)."""
    size, speeds = d.shape[1], d.shape[3]
    out = np.empty((2, size, loads, speeds))
    for i in range(size):
        x = i - i % 2
        for f in range(loads):
            for s in range(speeds):
                a, b, e, g = d[0, i, 0, s], d[1, i, 0, s], d[0, i, 1, s], d[1, i, 1, s]
                xr, xi = H[0, x, size + f, s], H[1, x, size + f, s]
                yr, yi = H[0, x + 1, size + f, s], H[1, x + 1, size + f, s]
                out[0, i, f, s] = a * xr - b * xi + e * yr - g * yi
                out[1, i, f, s] = a * xi + b * xr + e * yi + g * yr
    return out


@_njit
def _by_coefficient(omega: Real, group: Integer, w: Real, q: Real, p: int, row: Real, out: Complex) -> None:
    """Sum -w_i q_j over every group's bearings: its derivatives by k; those by c are j Omega times that."""
    for g in range(len(out)):
        for place in range(4):
            row[:] = 0.0
            for b in range(len(group)):
                if group[b] != g:
                    continue
                m, n = 2 * b + place // 2, 2 * b + place % 2
                for s in range(len(omega)):
                    row[0, s] += w[1, m, s] * q[1, n, s] - w[0, m, s] * q[0, n, s]
                    row[1, s] -= w[0, m, s] * q[1, n, s] + w[1, m, s] * q[0, n, s]
            for s in range(len(omega)):
                out[g, place, p, s] = complex(row[0, s], row[1, s])
                out[g, 4 + place, p, s] = complex(-omega[s] * row[1, s], omega[s] * row[0, s])


@_njit
def _by_amount(H: Real, w: Real, direct: Real, p: int, row: Real, out: Complex) -> None:
    """H_pf - w^T D H_bf of one probe."""
    size = w.shape[1]
    for f in range(len(out)):
        row[:] = H[:, size + p, size + f]
        for b in range(size):
            for s in range(w.shape[2]):
                row[0, s] -= w[0, b, s] * direct[0, b, f, s] - w[1, b, s] * direct[1, b, f, s]
                row[1, s] -= w[0, b, s] * direct[1, b, f, s] + w[1, b, s] * direct[0, b, f, s]
        for s in range(w.shape[2]):
            out[f, p, s] = complex(row[0, s], row[1, s])


@_njit
def _subtract_last(x: Real) -> None:
    last = x.shape[2] - 1
    for part in range(2):
        for i in range(x.shape[1]):
            slow = x[part, i, last]
            for s in range(last):
                x[part, i, s] -= slow


@_njit
def _log_distance(x: Real, start: int, measured: Real, product: Real) -> float:
    """Eq. (15): the sum of |log10 measured - log10 predicted|, rows of `x` from `start`.

    One logarithm per speed and four probes: |log a| + |log b| = log(max(a, 1/a) max(b, 1/b)).
    """
    total = 0.0
    probes, speeds = measured.shape
    for first in range(0, probes, 4):
        product[:] = 1.0
        for p in range(first, min(first + 4, probes)):
            for s in range(speeds):
                want = measured[p, s] * measured[p, s]
                have = x[0, start + p, s] * x[0, start + p, s] + x[1, start + p, s] * x[1, start + p, s]
                ratio = want / have if want > have else have / want
                product[s] *= 1.0 if np.isnan(want) else ratio
        for s in range(speeds):
            total += np.log(product[s])
    return total / (2 * np.log(10.0))


@_njit
def _distance(x: Real, start: int, measured: Real, objective: int) -> float:
    """Eq. (14) [um^2] or (16) [um], rows of `x` from `start`."""
    total = 0.0
    for p in range(measured.shape[0]):
        for s in range(measured.shape[1]):
            off = 1e6 * (measured[p, s] - np.sqrt(x[0, start + p, s] ** 2 + x[1, start + p, s] ** 2))
            if not np.isnan(off):
                total += off * off if objective == F1 else abs(off)
    return total
