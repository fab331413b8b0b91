"""Harmonic balance: the harmonics of a force law on a periodic motion, and the motion in balance with them.

A place moves as x = mean + Re(Q e^{j psi}) and its overtones; force_harmonics.py gives mean and harmonics of the force
on that motion. What the force does to the place is linear: u = known + A F(u), solved by Broyden's method (Math. Comp.
19 (1965) 577) from a Jacobian by differences of the force at every angle, which serves on where the problem changes
little from one turn or speed to the next.

u and F are (part,) = (7 place,), place being x and y of every law in turn: all means, then of one harmonic after the
other all real parts and all imaginary ones. Where no law is evaluated with its overtones, they are (3 place,).
"""

import warnings
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numba import njit, types
from numba.core.errors import NumbaExperimentalFeatureWarning
from numpy.typing import NDArray

from rotorrig.sims.rotor.nonlinear.force_harmonics import (
    REORDERED,
    every_harmonics,
    every_slopes,
    harmonics,
    largest,
    slopes_of,
)
from rotorrig.sims.rotor.nonlinear.force_law import POINTER, ForceLaw
from rotorrig.sims.rotor.swept import invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

LAWS = 2  # the kernels are compiled for that many, or a multiple: handing one over takes 0.2 ms
ACCURACY = 1e-8  # of the motion
MOST_STEPS = 40
SLOW = 0.5  # a step that leaves more of the residual wants a new Jacobian

REALS = {n: types.Array(types.float64, n, "C") for n in (1, 2)}  # by number of axes
COMPLEX = {n: types.Array(types.complex128, n, "C") for n in (2, 3, 4)}
_ON_MOTIONS = (REALS[2], REALS[1], REALS[2])  # the types of constants, speeds and motions


def pack_laws(laws: Sequence[ForceLaw]) -> tuple[tuple[Any, ...], Reals]:
    """Pack the laws for a kernel: their functions, a multiple of `LAWS` of them, and their constants, (law, n).

    The constants are padded to one length, and two behind them are left for the shaft's angle.
    """
    constants = np.zeros((len(laws), max(len(law.constants) for law in laws) + 2))
    for row, law in zip(constants, laws, strict=True):
        row[: len(law.constants)] = law.constants
    unused = (laws[0].force,) * (-len(laws) % LAWS)
    return (*(law.force for law in laws), *unused), constants


def call_kernel(kernel: Any, arguments: Sequence[Any], functions: tuple[Any, ...], *values: Any) -> Any:
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
    functions, constants = pack_laws(laws)
    result: Reals = call_kernel(every_harmonics, _ON_MOTIONS, functions, constants, omega, u)
    return result


def slopes(laws: Sequence[ForceLaw], omega: Reals, u: Reals) -> Reals:
    """Return dF / du of these forces, (n, part, part)."""
    functions, constants = pack_laws(laws)
    result: Reals = call_kernel(every_slopes, _ON_MOTIONS, functions, constants, omega, u)
    return result


def overtones(laws: Sequence[ForceLaw], omega: Reals, u: Reals, F: Reals, order: int) -> Complex:
    """Return a harmonic of the forces F on motions u, (n, place): 2 mean(f e^{-j order psi}); of order 0 the mean.

    Where the motions have no overtones, those of the force are computed here.
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
def solve_balance(
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
    guess of the inverse Jacobian of u - known - A F(u), and left as the latest estimate.
    """
    size = len(u)
    r, new_r, new_u, new_F, step, change = np.empty((6, size))
    fresh = False
    error = _residual(functions, constants, omega, known, A, mean, u, F, r)
    for _ in range(MOST_STEPS):
        if error <= ACCURACY * largest(u):
            return True
        _newton(inverse, r, step)
        for i in range(size):
            new_u[i] = u[i] + step[i]
        new_error = _residual(functions, constants, omega, known, A, mean, new_u, new_F, new_r)
        if not new_error < SLOW * error:
            if not fresh:
                _jacobian(functions, constants, omega, A, mean, u, inverse)
                fresh = True
                continue
            part = 1.0
            while not new_error < error and part > 1e-3:
                part /= 2
                for i in range(size):
                    new_u[i] = u[i] + part * step[i]
                new_error = _residual(functions, constants, omega, known, A, mean, new_u, new_F, new_r)
            fresh = False
        for i in range(size):
            step[i], change[i] = new_u[i] - u[i], new_r[i] - r[i]
            u[i], F[i], r[i] = new_u[i], new_F[i], new_r[i]
        _update_inverse(inverse, step, change)
        error = new_error
    return False


@njit(cache=True)
def predict(known: Reals, A: Complex, mean: Reals, u: Reals, F: Reals, inverse: Reals) -> None:
    """Predict u from its guess and that of F: a Newton step to what is known, without evaluating the force."""
    r, step = np.empty((2, len(u)))
    _put_error(known, A, mean, u, F, r)
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
    harmonics(functions, constants, omega, u, F)
    _put_error(known, A, mean, u, F, r)
    return largest(r)


@njit(cache=True)
def _put_error(known: Reals, A: Complex, mean: Reals, u: Reals, F: Reals, r: Reals) -> None:
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


@njit(cache=True)
def _jacobian(
    functions: tuple[Callable, ...], constants: Reals, omega: float, A: Complex, mean: Reals, u: Reals, inverse: Reals
) -> None:
    """Put the inverse Jacobian at u into `inverse`."""
    size, (harmonics, count) = len(u), A.shape[:2]
    by, work = np.eye(size), np.empty((size, size))
    slope = np.zeros((size, size))
    slopes_of(functions, constants, omega, u, slope)
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
def _update_inverse(inverse: Reals, step: Reals, change: Reals) -> None:
    """Update the inverse Jacobian so that it takes `change` to `step`: Broyden's update, by Sherman and Morrison."""
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
