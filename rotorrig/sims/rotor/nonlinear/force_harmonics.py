"""Kernels of harmonic_balance.py: mean and harmonics of a force on a periodic motion, and their derivatives.

A place moves as x = mean + Re(Q e^{j psi}) and its overtones up to the third; its force is evaluated at POINTS angles
and its mean and harmonics taken (alternating frequency and time: Cameron, Griffin, J. Appl. Mech. 56 (1989) 149).
The kernels are loops throughout: numba takes ten times as long to compile expressions of whole arrays, and on so few
numbers they are slower too. numba's cache of a function does not see changes to what it calls in another file: after
a change here, delete the *.nbi and *.nbc beside what calls it (harmonic_balance.py, law_stepping.py,
steady_response.py).

Motions u and forces F are (part,) = (7 place,), place being x and y of every law in turn: all means, then of one
harmonic after the other all real parts and all imaginary ones. Where no law is evaluated with its overtones,
they are (3 place,).
"""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

Reals = NDArray[np.float64]

OVERTONES = (2, 3)  # of the motion that the force's own overtones move, and that act back on the force
POINTS = 32  # a turn
STEP = 1e-6  # of the motion, of the differences
TINY = 1e-15  # m
REORDERED = {"reassoc", "contract", "nsz"}  # sums may be: several at once, but no number is taken to be finite
_TURNED = 2 * np.pi / POINTS * np.outer(np.arange(2 * OVERTONES[-1] + 1), np.arange(POINTS))
COSINE, SINE = np.cos(_TURNED), np.sin(_TURNED)  # (n, point) of n psi, up to the sum of two harmonics


@njit(cache=True)
def every_harmonics(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    """Return mean and harmonics of the forces on the motions u at speeds (n,), both (n, part)."""
    out = np.empty(u.shape)
    for k in range(len(u)):
        harmonics(functions, constants, omega[k], u[k], out[k])
    return out


@njit(cache=True, fastmath=REORDERED)
def harmonics(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, F: Reals) -> None:
    """Put the mean and the harmonics of the force on a motion u into F."""
    count = 2 * len(constants)
    path, force = np.empty((4, POINTS)), np.empty((2, POINTS))
    for law in range(len(constants)):
        _put_path(u, count, law, omega, path)
        _put_forces(functions[law], constants[law], path, force)
        for axis in range(2):
            mean = 0.0
            for p in range(POINTS):
                mean += force[axis, p]
            F[2 * law + axis] = mean / POINTS
            for h in range(1, len(u) // count // 2 + 1):
                re, im = 0.0, 0.0
                for p in range(POINTS):
                    re += force[axis, p] * COSINE[h, p]
                    im -= force[axis, p] * SINE[h, p]
                F[(2 * h - 1) * count + 2 * law + axis] = 2 * re / POINTS
                F[2 * h * count + 2 * law + axis] = 2 * im / POINTS


@njit(cache=True, fastmath=REORDERED)
def _put_path(u: Reals, count: int, law: int, omega: float, path: Reals) -> None:
    """Put x, y and their velocities, Re(j h Omega Q e^{j h psi}) of harmonic h, at every point into (4, point)."""
    for axis in range(2):
        for p in range(POINTS):
            path[axis, p], path[2 + axis, p] = u[2 * law + axis], 0.0
        for h in range(1, len(u) // count // 2 + 1):
            re, im = u[(2 * h - 1) * count + 2 * law + axis], u[2 * h * count + 2 * law + axis]
            for p in range(POINTS):
                path[axis, p] += re * COSINE[h, p] - im * SINE[h, p]
                path[2 + axis, p] -= h * omega * (re * SINE[h, p] + im * COSINE[h, p])


@njit(cache=True)
def _put_forces(function: Callable, constants: Reals, path: Reals, force: Reals) -> None:
    """Put the force at every point of a turn into `force` (2, point)."""
    for p in range(POINTS):
        constants[-2], constants[-1] = COSINE[1, p], SINE[1, p]
        force[0, p], force[1, p] = function(path[0, p], path[1, p], path[2, p], path[3, p], constants)


@njit(cache=True)
def every_slopes(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    """Return dF / du of these forces, (n, part, part)."""
    out = np.zeros((*u.shape, u.shape[1]))
    for k in range(len(u)):
        slopes_of(functions, constants, omega[k], u[k], out[k])
    return out


@njit(cache=True)
def slopes_of(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, slope: Reals) -> None:
    """Put dF / du at the motion u into `slope` (part, part), else zero: a law's force depends on its own place."""
    count = 2 * len(constants)
    path, by = np.empty((4, POINTS)), np.empty((4, 2, POINTS))
    cosine, sine = np.empty((2, 4, 2, len(COSINE)))
    step = STEP * largest(u) + TINY
    for law in range(len(constants)):
        _put_path(u, count, law, omega, path)
        _put_differences(functions[law], constants[law], omega, path, step, by)
        _put_spectrum(by, cosine, sine)
        for b in range(2):
            for a in range(2):
                _add_slopes(cosine, sine, b, a, 2 * law + a, 2 * law + b, count, slope)


@njit(cache=True)
def _put_differences(function: Callable, constants: Reals, omega: float, path: Reals, step: float, by: Reals) -> None:
    """Put d(fx, fy) by x, y and their velocities over Omega at every point of a turn into `by` (4, 2, point)."""
    for p in range(POINTS):
        constants[-2], constants[-1] = COSINE[1, p], SINE[1, p]
        x, y, vx, vy = path[0, p], path[1, p], path[2, p], path[3, p]
        fx, fy = function(x, y, vx, vy, constants)
        gx, gy = function(x + step, y, vx, vy, constants)
        by[0, 0, p], by[0, 1, p] = (gx - fx) / step, (gy - fy) / step
        gx, gy = function(x, y + step, vx, vy, constants)
        by[1, 0, p], by[1, 1, p] = (gx - fx) / step, (gy - fy) / step
        gx, gy = function(x, y, vx + omega * step, vy, constants)
        by[2, 0, p], by[2, 1, p] = (gx - fx) / step, (gy - fy) / step
        gx, gy = function(x, y, vx, vy + omega * step, constants)
        by[3, 0, p], by[3, 1, p] = (gx - fx) / step, (gy - fy) / step


@njit(cache=True, fastmath=REORDERED)
def _put_spectrum(by: Reals, cosine: Reals, sine: Reals) -> None:
    """Put mean(by cos(n psi)) and mean(by sin(n psi)) of (4, 2, point) into `cosine` and `sine` (4, 2, n)."""
    for i in range(4):
        for a in range(2):
            for n in range(len(COSINE)):
                c, s = 0.0, 0.0
                for p in range(POINTS):
                    c += by[i, a, p] * COSINE[n, p]
                    s += by[i, a, p] * SINE[n, p]
                cosine[i, a, n], sine[i, a, n] = c / POINTS, s / POINTS


@njit(cache=True)
def _add_slopes(cosine: Reals, sine: Reals, b: int, a: int, row: int, column: int, count: int, slope: Reals) -> None:
    """Put the derivatives of a force's parts along axis a by a motion's along axis b into `slope` (part, part).

    `cosine` and `sine` (4, 2, n) are the means of f_x cos(n psi) and f_x sin(n psi), and of f_v likewise, where df =
    f_x dx + f_v dv / Omega; dx is cos(h psi) for the real part of harmonic h and -sin(h psi) for the imaginary one.
    """
    harmonics = len(slope) // count // 2
    for i in range(harmonics + 1):
        for j in range(harmonics + 1):
            n, m, sign = i + j, abs(i - j), 1.0 if i > j else -1.0
            half = 0.5 if i == 0 else 1.0  # the mean of a force, but twice the mean for its harmonics
            c_n, c_m, s_n, s_m = cosine[b, a, n], cosine[b, a, m], sine[b, a, n], sign * sine[b, a, m]
            v = 2 + b
            cv_n, cv_m, sv_n, sv_m = cosine[v, a, n], cosine[v, a, m], sine[v, a, n], sign * sine[v, a, m]
            re_i, im_i = max(2 * i - 1, 0) * count + row, 2 * i * count + row
            re_j, im_j = max(2 * j - 1, 0) * count + column, 2 * j * count + column
            if i and j:
                slope[im_i, im_j] = half * (c_m - c_n + j * (sv_n + sv_m))
            if i:
                slope[im_i, re_j] = -half * (s_n + s_m - j * (cv_m - cv_n))
            if j:
                slope[re_i, im_j] = -half * (s_n - s_m + j * (cv_m + cv_n))
            slope[re_i, re_j] = half * (c_m + c_n - j * (sv_n - sv_m))


@njit(cache=True)
def largest(values: Reals) -> float:
    """Return the largest magnitude of some numbers."""
    largest = 0.0
    for value in values:
        largest = max(largest, abs(value))
    return largest
