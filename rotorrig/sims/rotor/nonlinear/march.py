"""Steps the passed modes with a force law from turn to turn: march.py, with an unknown force at the end of each step.

The force's harmonics are a polynomial in time over a step: where it is a small part of what moves the place, a cubic
through its last values (with the exact linear flow this is Adams and Moulton's fourth order for the force), else a
straight line, which is stable however stiff the law (Hairer, Wanner, Solving Ordinary Differential Equations II,
1996, ch. V.1).
"""

from collections.abc import Callable

import numpy as np
from numba import njit, types
from numpy.typing import NDArray

from rotorrig.sims.rotor.nonlinear.harmonic_balance import COMPLEX, REALS, foresee, settle
from rotorrig.sims.rotor.swept import SMOOTH, STRAIGHT, invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

STIFF = 0.4  # the part of the motion that is moved by the force of the same instant

MARCH = (
    *(REALS[2], REALS[1], REALS[1], COMPLEX[3], COMPLEX[4], COMPLEX[2], COMPLEX[2], COMPLEX[2]),
    *(COMPLEX[3], COMPLEX[3], COMPLEX[2], COMPLEX[3], REALS[2], COMPLEX[4], types.int64),
)  # the types of march's arguments after the functions


@njit(cache=True)
def march(
    functions: tuple[Callable, ...],
    constants: Reals,
    static: Reals,
    omega: Reals,
    L: Complex,
    steps: Complex,
    turned: Complex,
    force: Complex,
    force_mid: Complex,
    push: Complex,
    seen: Complex,
    base: Complex,
    flexibility: Complex,
    mean: Reals,
    above: Complex,
    most: int,
) -> tuple[Complex, Complex, Reals, Reals, int]:
    """Return a and a' (turn, mode), the place's motion and the force on it (turn, part), and how many failed.

    L (turn, mode, mode), `steps`, `turned` as in march.advanced; `force` (turn, mode) and `force_mid` of the loads.
    A unit of force at the place gives `push` (turn, mode, place) to the modes, of which it sees `seen` (turn, place,
    mode), and moves it by `flexibility` (turn, place, place) at once; the loads move it by `base` (turn, place). The
    mean force shifts it by `mean` (place, place) from `static` (place,), its overtones move it by `above` (turn,
    overtone, place, place), as in steady motion. It begins in the steady state and ends when more than `most` failed.
    """
    turns, modes, places = push.shape
    a, rate = np.zeros((turns, modes), dtype=np.complex128), force.copy()
    parts = (3 + 2 * above.shape[1]) * places
    u, F = np.zeros((2, turns, parts))
    forces = np.zeros((3, places), dtype=np.complex128)  # at the turn, and at the two before it
    free, moved = np.zeros(modes, dtype=np.complex128), np.zeros((modes, places), dtype=np.complex128)
    A = np.empty((1 + above.shape[1], places, places), dtype=np.complex128)
    known, inverse = np.zeros(parts), np.eye(parts)
    failed = 0
    _begin(L[0], force[0], push[0], free, moved)
    for k in range(turns):
        comply(flexibility[k], seen[k], moved, A[0])
        A[1:] = above[k]
        _foresee(static, base[k], seen[k], free, known)
        if not _found(k, functions, constants, omega, known, A, mean, u, F, inverse):
            failed += 1
            if failed > most:
                break
        for i in range(places):
            forces[2, i], forces[1, i] = forces[1, i], forces[0, i]
            forces[0, i] = complex(F[k, places + i], F[k, 2 * places + i])
        a[k] = free
        add(moved, forces[0], 1.0, a[k])
        add(push[k], forces[0], 1.0, rate[k])  # so far all that pushes
        if k + 1 < turns:
            weights = interpolation(k, A[0], F, u)
            _coast(k, steps[k], turned[k], a[k], rate[k], force_mid[k], force[k + 1], push, forces, weights, free)
            press_ahead(steps[k], turned[k], push[k], push[k + 1], weights[0], moved)
        add(L[k], a[k], 1.0, rate[k])
    return a, rate, u, F, failed


@njit(cache=True)
def _found(
    k: int,
    functions: tuple[Callable, ...],
    constants: Reals,
    omega: Reals,
    known: Reals,
    A: Complex,
    mean: Reals,
    u: Reals,
    F: Reals,
    inverse: Reals,
) -> bool:
    """Find the motion and the force of turn k; return whether that went well.

    It begins where the last two turns point, moved on by what is known by now; if that leads nowhere, at the last turn.
    """
    if k > 1:
        for i in range(len(known)):
            u[k, i], F[k, i] = 2 * u[k - 1, i] - u[k - 2, i], 2 * F[k - 1, i] - F[k - 2, i]
        foresee(known, A, mean, u[k], F[k], inverse)
        if settle(functions, constants, omega[k], known, A, mean, u[k], F[k], inverse):
            return True
    u[k] = known if k == 0 else u[k - 1]
    inverse[:] = np.eye(len(known))
    return settle(functions, constants, omega[k], known, A, mean, u[k], F[k], inverse)


@njit(cache=True)
def comply(flexibility: Complex, seen: Complex, moved: Complex, A: Complex) -> None:
    """Put by how much a unit of force moves the places within the same instant into A (place, place)."""
    for i in range(len(A)):
        for j in range(len(A)):
            A[i, j] = flexibility[i, j]
            for mode in range(len(moved)):
                A[i, j] += seen[i, mode] * moved[mode, j]


@njit(cache=True)
def interpolation(k: int, A: Complex, F: Reals, u: Reals) -> tuple[float, float, float, float]:
    """Return the weights of the force halfway to turn k + 1, of F and u known up to turn k."""
    return SMOOTH if k > 1 and not _is_stiff(A, F[k - 1 : k + 1], u[k - 1 : k + 1]) else STRAIGHT


@njit(cache=True)
def press_ahead(step: Complex, turned: Complex, push: Complex, later: Complex, weight: float, moved: Complex) -> None:
    """Put what a unit of force at the next turn does to the modes there into `moved` (mode, place)."""
    middle, end = turned
    ahead = end.conjugate() * middle * weight / 2
    for i in range(moved.shape[1]):
        for mode in range(len(moved)):
            moved[mode, i] = 0
        add(step[2], push[:, i], ahead, moved[:, i])
        add(step[2], later[:, i], ahead, moved[:, i])
        add(step[3], later[:, i], 1.0, moved[:, i])


@njit(cache=True)
def add(A: Complex, x: Complex, factor: complex, y: Complex) -> None:
    """Add `factor` A x to the vector y."""
    for i in range(len(A)):
        total = 0j
        for j in range(len(x)):
            total += A[i, j] * x[j]
        y[i] += factor * total


@njit(cache=True)
def _begin(L: Complex, force: Complex, push: Complex, free: Complex, moved: Complex) -> None:
    """Put the steady state under the loads into `free` (mode,), and under a unit of force at every place into `moved`.

    In general they are the state at a turn less what the force of that very turn does, and what a unit of it does.
    """
    at_rest, work = np.empty((2, *L.shape), dtype=np.complex128)
    invert(L, at_rest, work)
    add(at_rest, force, -1.0, free)
    for i in range(push.shape[1]):
        add(at_rest, push[:, i], -1.0, moved[:, i])


@njit(cache=True)
def _foresee(static: Reals, base: Complex, seen: Complex, free: Complex, known: Reals) -> None:
    """Put the motion of the places without the force of the turn into `known` (part,), no overtones."""
    places = len(static)
    for i in range(places):
        Q = base[i]
        for mode in range(len(free)):
            Q += seen[i, mode] * free[mode]
        known[i], known[places + i], known[2 * places + i] = static[i], Q.real, Q.imag


@njit(cache=True)
def _coast(
    k: int,
    step: Complex,
    turned: Complex,
    a: Complex,
    rate: Complex,
    force_mid: Complex,
    force: Complex,
    push: Complex,
    forces: Complex,
    weights: tuple[float, float, float, float],
    free: Complex,
) -> None:
    """Put the state at turn k + 1 without the force at the places there into `free`; `rate` is all that pushes at k."""
    middle, end = turned
    halfway, pushed = np.empty(forces.shape[1], dtype=np.complex128), force_mid.copy()
    for i in range(len(halfway)):
        halfway[i] = (weights[1] * forces[0, i] + weights[2] * forces[1, i] + weights[3] * forces[2, i]) / 2
    add(push[k], halfway, 1.0, pushed)  # `push` halfway is the mean of both turns
    add(push[k + 1], halfway, 1.0, pushed)
    for i in range(len(free)):
        free[i] = 0
    add(step[0], a, end.conjugate(), free)
    add(step[1], rate, end.conjugate(), free)
    add(step[2], pushed, end.conjugate() * middle, free)
    add(step[3], force, 1.0, free)


@njit(cache=True)
def _is_stiff(A: Complex, F: Reals, u: Reals) -> bool:
    """Return whether the force of the instant moves the place by a good part of its motion, or of its last change."""
    count = len(A)
    by_force, by_change, size, change = 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        total, last = 0j, 0j
        for j in range(count):
            total += A[i, j] * complex(F[1, count + j], F[1, 2 * count + j])
            last += A[i, j] * complex(F[0, count + j], F[0, 2 * count + j])
        Q, Q_last = complex(u[1, count + i], u[1, 2 * count + i]), complex(u[0, count + i], u[0, 2 * count + i])
        by_force, by_change = max(by_force, abs(total)), max(by_change, abs(total - last))
        size, change = max(size, abs(Q)), max(change, abs(Q - Q_last))
    return by_force > STIFF * size or by_change > STIFF * change
