"""The harmonics of a force law on a harmonic motion, and the motion that goes with them.

A place moves as x = mean + Re(Q e^{j psi}); its force is evaluated at POINTS angles and its mean, first and higher
harmonics taken (alternating frequency and time: Cameron, Griffin, J. Appl. Mech. 56 (1989) 149). What the force does
to the place is linear: u = known + A F(u), solved by Broyden's method (Math. Comp. 19 (1965) 577) from a Jacobian of
differences, which serves on where the problem changes little from one turn or speed to the next.
The kernels are loops throughout: numba takes ten times as long to compile expressions of whole arrays, and on so few
numbers they are slower too.

u and F are (3 place,), place being x and y of every law in turn: all means, all real parts, all imaginary ones.
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
POINTS = 32  # a turn
ACCURACY = 1e-8  # of the motion
MOST_STEPS = 40
SLOW = 0.5  # a step that leaves more of the residual wants a new Jacobian
STEP = 1e-6  # of the motion, of the differences
TINY = 1e-18  # m
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
    """Return mean and first harmonic of the forces of laws on the motions u at speeds (n,), both (n, 3 place) N."""
    functions, constants = pointers(laws)
    found: Reals = called(_every_harmonics, _ON_MOTIONS, functions, constants, omega, u)
    return found


def overtones(laws: Sequence[ForceLaw], omega: Reals, u: Reals, order: int) -> Complex:
    """Return a harmonic of these forces, (n, place): 2 mean(f e^{-j order psi}); of order 0 it is the mean."""
    functions, constants = pointers(laws)
    found: Complex = called(_every_overtone, (*_ON_MOTIONS, types.int64), functions, constants, omega, u, order)
    return found


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

    A (place, place) is what the first harmonic does, `mean` (place, place) what the mean does. `inverse` is a guess of
    the inverse Jacobian of u - known - A F(u), and left as the last one found.
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
                _jacobian(functions, constants, omega, known, A, mean, u, r, inverse)
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
    count = u.shape[1] // 3
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
    count = len(A)
    _harmonics(functions, constants, omega, u, F)
    for i in range(len(F)):
        r[i] = u[i] - known[i]
    for i in range(count):
        for k in range(count):
            moved = A[i, k] * complex(F[count + k], F[2 * count + k])
            r[i] -= mean[i, k] * F[k]
            r[count + i] -= moved.real
            r[2 * count + i] -= moved.imag
    return _largest(r)


@njit(cache=True)
def _harmonics(functions: tuple[Callable, ...], constants: Reals, omega: float, u: Reals, F: Reals) -> None:
    """Put the mean and the first harmonic of the force on a motion u into F."""
    count = len(u) // 3
    for law in range(len(constants)):
        m, n = 2 * law, 2 * law + 1
        F[m] = F[n] = F[count + m] = F[count + n] = F[2 * count + m] = F[2 * count + n] = 0
        for p in range(POINTS):
            fx, fy = _force(functions[law], constants[law], omega, u, count, law, p)
            F[m] += fx
            F[n] += fy
            F[count + m] += fx * COSINE[p]
            F[count + n] += fy * COSINE[p]
            F[2 * count + m] -= fx * SINE[p]
            F[2 * count + n] -= fy * SINE[p]
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
    """Return the force at one of the points of a turn; the velocity is Re(j Omega Q e^{j psi})."""
    m, n, c, s = 2 * law, 2 * law + 1, COSINE[p], SINE[p]
    constants[-2], constants[-1] = c, s
    xr, yr, xi, yi = u[count + m], u[count + n], u[2 * count + m], u[2 * count + n]
    return function(
        u[m] + xr * c - xi * s,
        u[n] + yr * c - yi * s,
        -omega * (xr * s + xi * c),
        -omega * (yr * s + yi * c),
        constants,
    )


@njit(cache=True)
def _jacobian(
    functions: tuple[Callable, ...],
    constants: Reals,
    omega: float,
    known: Reals,
    A: Complex,
    mean: Reals,
    u: Reals,
    r: Reals,
    inverse: Reals,
) -> None:
    """Put the inverse Jacobian at u, where the residual is r, by differences, into `inverse`."""
    size = len(u)
    by, work = np.empty((2, size, size))
    moved, F, found = np.empty((3, size))
    for i in range(size):
        moved[i] = u[i]
    step = STEP * max(_largest(u), STEP * _largest(known)) + TINY
    for i in range(size):
        moved[i] = u[i] + step
        _residual(functions, constants, omega, known, A, mean, moved, F, found)
        for k in range(size):
            by[k, i] = (found[k] - r[k]) / step
        moved[i] = u[i]
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
