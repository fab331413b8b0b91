"""The harmonics of a force law on a periodic motion, and the motion that goes with them.

A place moves as x = mean + Re(Q e^{j psi}) and its overtones up to the third; its force is evaluated at POINTS angles
and its mean and harmonics taken (alternating frequency and time: Cameron, Griffin, J. Appl. Mech. 56 (1989) 149). What
the force does to the place is linear: u = known + A F(u), solved by Broyden's method (Math. Comp. 19 (1965) 577) from a
Jacobian by differences of the force at every angle, which serves on where the problem changes little from one turn or
speed to the next.
The kernels are loops throughout: numba takes ten times as long to compile expressions of whole arrays, and on so few
numbers they are slower too.

u and F are (part,) = (7 place,), place being x and y of every law in turn: all means, then of one harmonic after the
other all real parts and all imaginary ones. Where no law is found with its overtones, they are (3 place,).
"""

import warnings
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numba import njit, types
from numba.core.errors import NumbaExperimentalFeatureWarning
from numpy.typing import NDArray

from rotorrig.sims.rotor.force_law import POINTER, ForceLaw
from rotorrig.sims.rotor.march import invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

LAWS = 2  # the kernels are compiled for that many, or a multiple: handing one over takes 0.2 ms
OVERTONES = (2, 3)  # of the motion: what the force's own move, and what that makes of the force
POINTS = 32  # a turn
ACCURACY = 1e-8  # of the motion
MOST_STEPS = 40
SLOW = 0.5  # a step that leaves more of the residual wants a new Jacobian
STEP = 1e-6  # of the motion, of the differences
TINY = 1e-15  # m
REORDERED = {"reassoc", "contract", "nsz"}  # sums may be: several at once, but no number is taken to be finite
_TURNED = 2 * np.pi / POINTS * np.outer(np.arange(2 * OVERTONES[-1] + 1), np.arange(POINTS))
COSINE, SINE = np.cos(_TURNED), np.sin(_TURNED)  # (n, point) of n psi, up to the sum of two harmonics

REALS = {n: types.Array(types.float64, n, "C") for n in (1, 2)}  # by number of axes
COMPLEX = {n: types.Array(types.complex128, n, "C") for n in (2, 3, 4)}
_ON_MOTIONS = (REALS[2], REALS[1], REALS[2])  # the types of constants, speeds and motions


def pointers(laws: Sequence[ForceLaw]) -> tuple[tuple[Any, ...], Reals]:
    """Return the laws' functions, a multiple of `LAWS` of them, and their constants, (law, n).

    The constants are padded to one length, and two behind them are left for the shaft's angle.
    """
    constants = np.zeros((len(laws), max(len(law.constants) for law in laws) + 2))
    for row, law in zip(constants, laws, strict=True):
        row[: len(law.constants)] = law.constants
    unused = (laws[0].force,) * (-len(laws) % LAWS)
    return (*(law.force for law in laws), *unused), constants


def called(kernel: Any, arguments: Sequence[Any], functions: tuple[Any, ...], *values: Any) -> Any:
    """Call a kernel, compiled once for pointers to functions and `arguments` of those types."""
    _compile(kernel, len(functions), *arguments)
    with warnings.catch_warnings():  # that pointers to functions are new to numba
        warnings.simplefilter("ignore", NumbaExperimentalFeatureWarning)
        return kernel(functions, *values)


@cache
def _compile(kernel: Any, functions: int, *arguments: Any) -> None:
    kernel.compile((types.UniTuple(POINTER, functions), *arguments))


def forces(laws: Sequence[ForceLaw], omega: Reals, u: Reals) -> Reals:
    """Return mean and harmonics of the forces of laws on the motions u at speeds (n,), both (n, part) N."""
    functions, constants = pointers(laws)
    found: Reals = called(_every_harmonics, _ON_MOTIONS, functions, constants, omega, u)
    return found


def slopes(laws: Sequence[ForceLaw], omega: Reals, u: Reals) -> Reals:
    """Return dF / du of these forces, (n, part, part)."""
    functions, constants = pointers(laws)
    found: Reals = called(_every_slopes, _ON_MOTIONS, functions, constants, omega, u)
    return found


def overtones(laws: Sequence[ForceLaw], omega: Reals, u: Reals, F: Reals, order: int) -> Complex:
    """Return a harmonic of the forces F on motions u, (n, place): 2 mean(f e^{-j order psi}); of order 0 the mean.

    Where the motions have no overtones, those of the force are found here.
    """
    places = 2 * len(laws)
    if (2 * order + 1) * places > F.shape[1]:
        u = np.pad(u, ((0, 0), (0, (2 * order + 1) * places - u.shape[1])))
        F = forces(laws, omega, u)
    return F[:, :places].astype(complex) if order == 0 else phasor(F, places, order)


def phasor(u: Reals, places: int, order: int = 1) -> Complex:
    """Return a harmonic, (n, place, ...), of motions or forces (n, part, ...)."""
    re, im = (2 * order - 1) * places, 2 * order * places
    return u[:, re:im] + 1j * u[:, im : im + places]


@njit(cache=True)
def settle(
    functions: tuple[Callable, ...],
    constants: Reals,
    omega: float,
    known: Reals,
    A: Complex,
    mean: Reals,
    u: Reals,
    F: Reals,
    inverse: Reals,
) -> bool:
    """Solve u = known + A F(u) from the u given, in place; return whether it has been solved.

    A (harmonic, place, place) is what each harmonic does, `mean` (place, place) what the mean does. `inverse` is a
    guess of the inverse Jacobian of u - known - A F(u), and left as the last one found.
    """
    size = len(u)
    r, new_r, new_u, new_F, step, change = np.empty((6, size))
    fresh = False
    left = _residual(functions, constants, omega, known, A, mean, u, F, r)
    for _ in range(MOST_STEPS):
        if left <= ACCURACY * _largest(u):
            return True
        _newton(inverse, r, step)
        for i in range(size):
            new_u[i] = u[i] + step[i]
        new_left = _residual(functions, constants, omega, known, A, mean, new_u, new_F, new_r)
        if not new_left < SLOW * left:
            if not fresh:
                _jacobian(functions, constants, omega, A, mean, u, inverse)
                fresh = True
                continue
            part = 1.0
            while not new_left < left and part > 1e-3:
                part /= 2
                for i in range(size):
                    new_u[i] = u[i] + part * step[i]
                new_left = _residual(functions, constants, omega, known, A, mean, new_u, new_F, new_r)
            fresh = False
        for i in range(size):
            step[i], change[i] = new_u[i] - u[i], new_r[i] - r[i]
            u[i], F[i], r[i] = new_u[i], new_F[i], new_r[i]
        _learn(inverse, step, change)
        left = new_left
    return False


@njit(cache=True)
def foresee(known: Reals, A: Complex, mean: Reals, u: Reals, F: Reals, inverse: Reals) -> None:
    """Let a guess of u and F follow what is known: a step of `settle` for which the force is not evaluated."""
    r, step = np.empty((2, len(u)))
    _left(known, A, mean, u, F, r)
    _newton(inverse, r, step)
    for i in range(len(u)):
        u[i] += step[i]


@njit(cache=True, fastmath=REORDERED)
def _newton(inverse: Reals, r: Reals, step: Reals) -> None:
    """Put -inverse r into `step`."""
    for i in range(len(r)):
        total = 0.0
        for k in range(len(r)):
            total += inverse[i, k] * r[k]
        step[i] = -total


@njit(cache=True)
def _every_harmonics(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    found = np.empty(u.shape)
    for k in range(len(u)):
        _harmonics(functions, constants, omega[k], u[k], found[k])
    return found


@njit(cache=True)
def _residual(
    functions: tuple[Callable, ...],
    constants: Reals,
    omega: float,
    known: Reals,
    A: Complex,
    mean: Reals,
    u: Reals,
    F: Reals,
    r: Reals,
) -> float:
    """Put F(u) into F and u - known - A F into r; return the largest component of r."""
    _harmonics(functions, constants, omega, u, F)
    _left(known, A, mean, u, F, r)
    return _largest(r)


@njit(cache=True)
def _left(known: Reals, A: Complex, mean: Reals, u: Reals, F: Reals, r: Reals) -> None:
    """Put u - known - A F into r."""
    harmonics, count = A.shape[:2]
    for i in range(len(F)):
        r[i] = u[i] - known[i]
    for i in range(count):
        for k in range(count):
            r[i] -= mean[i, k] * F[k]
            for h in range(harmonics):
                re, im = (2 * h + 1) * count, (2 * h + 2) * count
                moved = A[h, i, k] * complex(F[re + k], F[im + k])
                r[re + i] -= moved.real
                r[im + i] -= moved.imag


@njit(cache=True, fastmath=REORDERED)
def _harmonics(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, F: Reals) -> None:
    """Put the mean and the harmonics of the force on a motion u into F."""
    count = 2 * len(constants)
    path, push = np.empty((4, POINTS)), np.empty((2, POINTS))
    for law in range(len(constants)):
        _path(u, count, law, omega, path)
        _push(functions[law], constants[law], path, push)
        for axis in range(2):
            mean = 0.0
            for p in range(POINTS):
                mean += push[axis, p]
            F[2 * law + axis] = mean / POINTS
            for h in range(1, len(u) // count // 2 + 1):
                re, im = 0.0, 0.0
                for p in range(POINTS):
                    re += push[axis, p] * COSINE[h, p]
                    im -= push[axis, p] * SINE[h, p]
                F[(2 * h - 1) * count + 2 * law + axis] = 2 * re / POINTS
                F[2 * h * count + 2 * law + axis] = 2 * im / POINTS


@njit(cache=True)
def _largest(values: Reals) -> float:
    largest = 0.0
    for value in values:
        largest = max(largest, abs(value))
    return largest


@njit(cache=True)
def _push(function: Callable, constants: Reals, path: Reals, push: Reals) -> None:
    """Put the force at every point of a turn into `push` (2, point)."""
    for p in range(POINTS):
        constants[-2], constants[-1] = COSINE[1, p], SINE[1, p]
        push[0, p], push[1, p] = function(path[0, p], path[1, p], path[2, p], path[3, p], constants)


@njit(cache=True, fastmath=REORDERED)
def _path(u: Reals, count: int, law: int, omega: float, path: Reals) -> None:
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
def _every_slopes(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    found = np.zeros((*u.shape, u.shape[1]))
    for k in range(len(u)):
        _slopes(functions, constants, omega[k], u[k], found[k])
    return found


@njit(cache=True)
def _slopes(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, slope: Reals) -> None:
    """Put dF / du at the motion u into `slope` (part, part), else zero: a law's force depends on its own place."""
    count = 2 * len(constants)
    path, by = np.empty((4, POINTS)), np.empty((4, 2, POINTS))
    cosine, sine = np.empty((2, 4, 2, len(COSINE)))
    step = STEP * _largest(u) + TINY
    for law in range(len(constants)):
        _path(u, count, law, omega, path)
        _differences(functions[law], constants[law], omega, path, step, by)
        _spectrum(by, cosine, sine)
        for b in range(2):
            for a in range(2):
                _add_slopes(cosine, sine, b, a, 2 * law + a, 2 * law + b, count, slope)


@njit(cache=True)
def _differences(function: Callable, constants: Reals, omega: float, path: Reals, step: float, by: Reals) -> None:
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
def _spectrum(by: Reals, cosine: Reals, sine: Reals) -> None:
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
    """Put what the parts of a motion along axis b make of those of a force along axis a into `slope` (part, part).

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
def _jacobian(
    functions: tuple[Callable, ...], constants: Reals, omega: float, A: Complex, mean: Reals, u: Reals, inverse: Reals
) -> None:
    """Put the inverse Jacobian at u into `inverse`."""
    size, (harmonics, count) = len(u), A.shape[:2]
    by, work = np.eye(size), np.empty((size, size))
    slope = np.zeros((size, size))
    _slopes(functions, constants, omega, u, slope)
    for i in range(count):
        for k in range(count):
            for j in range(size):
                by[i, j] -= mean[i, k] * slope[k, j]
            for h in range(harmonics):
                re, im, moved = (2 * h + 1) * count, (2 * h + 2) * count, A[h, i, k]
                for j in range(size):
                    by[re + i, j] -= moved.real * slope[re + k, j] - moved.imag * slope[im + k, j]
                    by[im + i, j] -= moved.imag * slope[re + k, j] + moved.real * slope[im + k, j]
    invert(by, inverse, work)


@njit(cache=True, fastmath=REORDERED)
def _learn(inverse: Reals, step: Reals, change: Reals) -> None:
    """Let the inverse Jacobian take `change` to `step`: Broyden's update, by Sherman and Morrison."""
    size = len(step)
    taken, back = np.zeros((2, size))
    weight, squared = 0.0, 0.0
    for i in range(size):
        total = 0.0
        for k in range(size):
            total += inverse[i, k] * change[k]
            back[k] += step[i] * inverse[i, k]
        taken[i] = total
        weight += step[i] * total
        squared += step[i] * step[i]
    if abs(weight) > 1e-3 * squared:
        for i in range(size):
            part = (step[i] - taken[i]) / weight
            for k in range(size):
                inverse[i, k] += part * back[k]
