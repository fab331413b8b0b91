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

LAWS = 4  # the kernels are compiled for that many, or a multiple
OVERTONES = (2, 3)  # of the motion: what the force's own move, and what that makes of the force
POINTS = 32  # a turn
ACCURACY = 1e-8  # of the motion
MOST_STEPS = 40
SLOW = 0.5  # a step that leaves more of the residual wants a new Jacobian
STEP = 1e-6  # of the motion, of the differences
TINY = 1e-15  # m
COSINE, SINE = (f(2 * np.pi * np.arange(POINTS) / POINTS) for f in (np.cos, np.sin))

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


def overtones(laws: Sequence[ForceLaw], omega: Reals, u: Reals, order: int) -> Complex:
    """Return a harmonic of these forces, (n, place): 2 mean(f e^{-j order psi}); of order 0 it is the mean."""
    functions, constants = pointers(laws)
    found: Complex = called(_every_overtone, (*_ON_MOTIONS, types.int64), functions, constants, omega, u, order)
    return found


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
        for i in range(size):
            step[i] = 0
            for k in range(size):
                step[i] -= inverse[i, k] * r[k]
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
def _every_harmonics(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    found = np.empty(u.shape)
    for k in range(len(u)):
        _harmonics(functions, constants, omega[k], u[k], found[k])
    return found


@njit(cache=True)
def _every_overtone(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals, order: int) -> Complex:
    count = 2 * len(constants)
    found = np.zeros((len(u), count), dtype=np.complex128)
    for k in range(len(u)):
        for law in range(len(constants)):
            for p in range(POINTS):
                fx, fy = _force(functions[law], constants[law], omega[k], u[k], count, law, p)
                q = order * p % POINTS
                turn = complex(COSINE[q], -SINE[q]) * (2 if order else 1) / POINTS
                found[k, 2 * law] += fx * turn
                found[k, 2 * law + 1] += fy * turn
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
    harmonics, count = A.shape[:2]
    _harmonics(functions, constants, omega, u, F)
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
    return _largest(r)


@njit(cache=True)
def _harmonics(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, F: Reals) -> None:
    """Put the mean and the harmonics of the force on a motion u into F."""
    count = 2 * len(constants)
    harmonics = len(u) // count // 2
    for i in range(len(F)):
        F[i] = 0
    for law in range(len(constants)):
        m, n = 2 * law, 2 * law + 1
        for p in range(POINTS):
            fx, fy = _force(functions[law], constants[law], omega, u, count, law, p)
            F[m] += fx
            F[n] += fy
            for h in range(harmonics):
                q, re, im = (h + 1) * p % POINTS, (2 * h + 1) * count, (2 * h + 2) * count
                F[re + m] += fx * COSINE[q]
                F[re + n] += fy * COSINE[q]
                F[im + m] -= fx * SINE[q]
                F[im + n] -= fy * SINE[q]
    for i in range(len(F)):
        F[i] *= (1 if i < count else 2) / POINTS


@njit(cache=True)
def _largest(values: Reals) -> float:
    largest = 0.0
    for value in values:
        largest = max(largest, abs(value))
    return largest


@njit(cache=True)
def _force(
    function: Callable, constants: Reals, omega: float, u: Reals, count: int, law: int, p: int
) -> tuple[float, float]:
    """Return the force at one of the points of a turn."""
    x, y, vx, vy = _motion(u, count, law, p)
    constants[-2], constants[-1] = COSINE[p], SINE[p]
    return function(x, y, omega * vx, omega * vy, constants)


@njit(cache=True)
def _motion(u: Reals, count: int, law: int, p: int) -> tuple[float, float, float, float]:
    """Return x, y there and their velocities over Omega: Re(j h Q e^{j h psi}) of harmonic h."""
    m, n = 2 * law, 2 * law + 1
    x, y, vx, vy = u[m], u[n], 0.0, 0.0
    for h in range(1, len(u) // count // 2 + 1):
        q, re, im = h * p % POINTS, (2 * h - 1) * count, 2 * h * count
        c, s = COSINE[q], SINE[q]
        x += u[re + m] * c - u[im + m] * s
        y += u[re + n] * c - u[im + n] * s
        vx -= h * (u[re + m] * s + u[im + m] * c)
        vy -= h * (u[re + n] * s + u[im + n] * c)
    return x, y, vx, vy


@njit(cache=True)
def _every_slopes(functions: tuple[Callable, ...], constants: Reals, omega: Reals, u: Reals) -> Reals:
    found = np.zeros((*u.shape, u.shape[1]))
    for k in range(len(u)):
        _slopes(functions, constants, omega[k], u[k], found[k])
    return found


@njit(cache=True)
def _slopes(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, slope: Reals) -> None:
    """Add dF / du at the motion u to `slope` (part, part): a law's force depends on the motion of its own place."""
    count = 2 * len(constants)
    parts = len(u) // count
    by = np.empty((4, 2))
    move, rate, take = np.empty((3, parts))
    step = STEP * _largest(u) + TINY
    for p in range(POINTS):
        _parts_at(p, move, rate, take)
        for law in range(len(constants)):
            _differences(functions[law], constants[law], omega, u, count, law, p, step, by)
            for b in range(2):
                for a in range(2):
                    for j in range(parts):
                        change = by[b, a] * move[j] + by[2 + b, a] * rate[j]
                        for i in range(parts):
                            slope[i * count + 2 * law + a, j * count + 2 * law + b] += take[i] * change


@njit(cache=True)
def _parts_at(p: int, move: Reals, rate: Reals, take: Reals) -> None:
    """Put how a unit of every part moves a place at a point of a turn, at what rate over Omega, and what it takes up.

    (1 + 2 harmonic,) each; the last is the weight of the force there in that part of it.
    """
    move[0], rate[0], take[0] = 1.0, 0.0, 1.0 / POINTS
    for h in range(1, len(move) // 2 + 1):
        c, s = COSINE[h * p % POINTS], SINE[h * p % POINTS]
        move[2 * h - 1], move[2 * h] = c, -s
        rate[2 * h - 1], rate[2 * h] = -h * s, -h * c
        take[2 * h - 1], take[2 * h] = 2 * c / POINTS, -2 * s / POINTS


@njit(cache=True)
def _differences(
    function: Callable, constants: Reals, omega: float, u: Reals, count: int, law: int, p: int, step: float, by: Reals
) -> None:
    """Put d(fx, fy) by x, y and their velocities over Omega at a point of a turn into `by` (4, 2)."""
    x, y, vx, vy = _motion(u, count, law, p)
    constants[-2], constants[-1] = COSINE[p], SINE[p]
    fx, fy = function(x, y, omega * vx, omega * vy, constants)
    for i in range(4):
        dx, dy = step if i == 0 else 0.0, step if i == 1 else 0.0
        dvx, dvy = step if i == 2 else 0.0, step if i == 3 else 0.0
        gx, gy = function(x + dx, y + dy, omega * (vx + dvx), omega * (vy + dvy), constants)
        by[i, 0], by[i, 1] = (gx - fx) / step, (gy - fy) / step


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


@njit(cache=True)
def _learn(inverse: Reals, step: Reals, change: Reals) -> None:
    """Let the inverse Jacobian take `change` to `step`: Broyden's update, by Sherman and Morrison."""
    size = len(step)
    taken, back = np.zeros((2, size))
    weight, squared = 0.0, 0.0
    for i in range(size):
        for k in range(size):
            taken[i] += inverse[i, k] * change[k]
            back[k] += step[i] * inverse[i, k]
        weight += step[i] * taken[i]
        squared += step[i] * step[i]
    if abs(weight) > 1e-3 * squared:
        for i in range(size):
            for k in range(size):
                inverse[i, k] += (step[i] - taken[i]) / weight * back[k]
