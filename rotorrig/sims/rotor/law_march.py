"""Steps the passed modes with a force law from turn to turn: march.py, with an unknown force at the end of each step.

The force's harmonics are a polynomial in time over a step: where it is a small part of what moves the place, a cubic
through its last values (with the exact linear flow this is Adams and Moulton's fourth order for the force), else a
straight line, which is stable however stiff the law (Hairer, Wanner, Solving Ordinary Differential Equations II,
1996, ch. V.1).
"""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.sims.rotor.describing import COMPLEX, REALS, settle
from rotorrig.sims.rotor.march import invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

STIFF = 0.4  # the part of the motion that is moved by the force of the same instant
SMOOTH = (5 / 16, 15 / 16, -5 / 16, 1 / 16)  # what the force halfway is of that at the end, at the start and before
STRAIGHT = (0.5, 0.5, 0.0, 0.0)

MARCH = (
    *(REALS[2], REALS[1], REALS[1], COMPLEX[3], COMPLEX[4], COMPLEX[2], COMPLEX[2], COMPLEX[2]),
    *(COMPLEX[3], COMPLEX[3], COMPLEX[2], COMPLEX[3], REALS[2]),
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
) -> tuple[Complex, Complex, Reals, Reals, int]:
    """Return a and a' (turn, mode), the place's motion and the force on it (turn, 3 place), and how many failed.

    L (turn, mode, mode), `steps`, `turned` as in march.advanced; `force` (turn, mode) and `force_mid` of the loads.
    A unit of force at the place gives `push` (turn, mode, place) to the modes, of which it sees `seen` (turn, place,
    mode), and moves it by `flexibility` (turn, place, place) at once; the loads move it by `base` (turn, place). The
    mean force shifts it by `mean` (place, place) from `static` (place,). It begins in the steady state.
    """
    turns, modes, places = push.shape
    a, rate = np.zeros((turns, modes), dtype=np.complex128), np.zeros((turns, modes), dtype=np.complex128)
    u, F, Q = np.zeros((turns, 3 * places)), np.zeros((turns, 3 * places)), np.empty(places, dtype=np.complex128)
    now, last, before = np.zeros((3, places), dtype=np.complex128)  # the force at the turn and at those before it
    moved, A = np.zeros((modes, places), dtype=np.complex128), np.empty((places, places), dtype=np.complex128)
    inverse, known, failed = np.eye(3 * places), np.empty(3 * places), 0
    free, pushed = np.zeros((2, modes), dtype=np.complex128)
    for i in range(places):
        known[i] = static[i]

    at_rest, work = np.empty((2, modes, modes), dtype=np.complex128)
    invert(L[0], at_rest, work)
    _add(at_rest, force[0], -1.0, free)
    for i in range(places):
        _add(at_rest, push[0, :, i], -1.0, moved[:, i])
    for k in range(turns):
        for i in range(places):
            Q[i] = base[k, i]
            for j in range(places):
                A[i, j] = flexibility[k, i, j]
        _add(seen[k], free, 1.0, Q)
        for i in range(places):
            _add(seen[k], moved[:, i], 1.0, A[:, i])
            known[places + i], known[2 * places + i] = Q[i].real, Q[i].imag
        for i in range(3 * places):
            u[k, i] = known[i] if k == 0 else u[k - 1, i] if k == 1 else 2 * u[k - 1, i] - u[k - 2, i]
        if not settle(functions, constants, omega[k], known, A, mean, u[k], F[k], inverse):
            failed += 1
        for i in range(places):
            before[i], last[i], now[i] = last[i], now[i], complex(F[k, places + i], F[k, 2 * places + i])
        for i in range(modes):
            a[k, i], rate[k, i] = free[i], force[k, i]
        _add(moved, now, 1.0, a[k])
        _add(push[k], now, 1.0, rate[k])  # so far all that pushes
        if k + 1 < turns:
            middle, end = turned[k]
            weights = SMOOTH if k > 1 and not _is_stiff(A, F[k - 1 : k + 1], u[k - 1 : k + 1]) else STRAIGHT
            for i in range(modes):
                pushed[i] = force_mid[k, i]  # halfway, where `push` is the mean of both turns
                free[i] = 0
                for j in range(places):
                    moved[i, j] = 0
            for i in range(places):
                Q[i] = (weights[1] * now[i] + weights[2] * last[i] + weights[3] * before[i]) / 2
            _add(push[k], Q, 1.0, pushed)
            _add(push[k + 1], Q, 1.0, pushed)
            _add(steps[k, 0], a[k], end.conjugate(), free)
            _add(steps[k, 1], rate[k], end.conjugate(), free)
            _add(steps[k, 2], pushed, end.conjugate() * middle, free)
            _add(steps[k, 3], force[k + 1], 1.0, free)
            for i in range(places):
                ahead = end.conjugate() * middle * weights[0] / 2
                _add(steps[k, 2], push[k, :, i], ahead, moved[:, i])
                _add(steps[k, 2], push[k + 1, :, i], ahead, moved[:, i])
                _add(steps[k, 3], push[k + 1, :, i], 1.0, moved[:, i])
        _add(L[k], a[k], 1.0, rate[k])
    return a, rate, u, F, failed


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


@njit(cache=True)
def _add(A: Complex, x: Complex, factor: complex, y: Complex) -> None:
    """Add `factor` A x to the vector y."""
    for i in range(len(A)):
        total = 0j
        for j in range(len(x)):
            total += A[i, j] * x[j]
        y[i] += factor * total
