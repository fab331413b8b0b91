"""Time stepping under force laws: the passed modes from turn to turn, with an unknown force at the end of each step.

The force's harmonics are a polynomial in time over a step: where it is a small part of what moves the place, a cubic
through its last values (with the exact linear flow this is Adams and Moulton's fourth order for the force), else a
straight line, which is stable however stiff the law (Hairer, Wanner, Solving Ordinary Differential Equations II,
1996, ch. V.1).
"""

from collections.abc import Callable

import numpy as np
from numba import njit, types
from numpy.typing import NDArray

from rotorrig.sims.rotor.nonlinear.harmonic_balance import COMPLEX, REALS, predict, solve_balance
from rotorrig.sims.rotor.swept import SMOOTH, STRAIGHT, invert

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

STIFF = 0.4  # of the motion: its part by the force of the same instant

STEPPING = (
    *(REALS[2], REALS[1], REALS[1], COMPLEX[3], COMPLEX[4], COMPLEX[2], COMPLEX[2], COMPLEX[2]),
    *(COMPLEX[3], COMPLEX[3], COMPLEX[2], COMPLEX[3], REALS[2], COMPLEX[4], types.int64),
)  # the types of step_with_laws' arguments after the functions


@njit(cache=True)
def step_with_laws(
    functions: tuple[Callable, ...],
    constants: Reals,
    static: Reals,
    omega: Reals,
    L: Complex,
    steps: Complex,
    phases: Complex,
    force: Complex,
    force_mid: Complex,
    participation: Complex,
    shapes: Complex,
    by_loads: Complex,
    flexibility: Complex,
    mean: Reals,
    overtones: Complex,
    most: int,
) -> tuple[Complex, Complex, Reals, Reals, int]:
    """Step a and a' (turn, mode) and the places' motion and force (turn, part); return them and the number of failures.

    L (turn, mode, mode), `steps`, `phases` as in time_stepping.step_modes; `force` (turn, mode) and `force_mid` of the
    loads. A unit of force at a place forces the modes by its `participation` (turn, mode, place); their `shapes` (turn,
    place, mode) move the places; `flexibility` (turn, place, place) and `by_loads` (turn, place) are the others' part,
    which follows at once. The mean force shifts a place by `mean` (place, place) from `static` (place,), its overtones
    move it by `overtones` (turn, overtone, place, place), as in steady motion. It begins in the steady state and ends
    when more than `most` turns failed.
    """
    turns, modes, places = participation.shape
    a, rate = np.zeros((turns, modes), dtype=np.complex128), force.copy()
    parts = (3 + 2 * overtones.shape[1]) * places
    u, F = np.zeros((2, turns, parts))
    forces = np.zeros((3, places), dtype=np.complex128)  # at the turn, and at the two before it
    free, unit_response = np.zeros(modes, dtype=np.complex128), np.zeros((modes, places), dtype=np.complex128)
    A = np.empty((1 + overtones.shape[1], places, places), dtype=np.complex128)
    known, inverse = np.zeros(parts), np.eye(parts)
    failed = 0
    _put_steady_start(L[0], force[0], participation[0], free, unit_response)
    for k in range(turns):
        put_compliance(flexibility[k], shapes[k], unit_response, A[0])
        A[1:] = overtones[k]
        _put_free_motion(static, by_loads[k], shapes[k], free, known)
        if not _solve_turn(k, functions, constants, omega, known, A, mean, u, F, inverse):
            failed += 1
            if failed > most:
                break
        for i in range(places):
            forces[2, i], forces[1, i] = forces[1, i], forces[0, i]
            forces[0, i] = complex(F[k, places + i], F[k, 2 * places + i])
        a[k] = free
        add_product(unit_response, forces[0], 1.0, a[k])
        add_product(participation[k], forces[0], 1.0, rate[k])  # so far the forces alone
        if k + 1 < turns:
            weights = halfway_weights(k, A[0], F, u)
            _put_free_response(
                k, steps[k], phases[k], a[k], rate[k], force_mid[k], force[k + 1], participation, forces, weights, free
            )
            put_unit_response(steps[k], phases[k], participation[k], participation[k + 1], weights[0], unit_response)
        add_product(L[k], a[k], 1.0, rate[k])
    return a, rate, u, F, failed


@njit(cache=True)
def _solve_turn(
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
    """Solve for the motion and the force of turn k; return whether that converged.

    It begins at the prediction from the last two turns, corrected by what is known by now; else at the last turn.
    """
    if k > 1:
        for i in range(len(known)):
            u[k, i], F[k, i] = 2 * u[k - 1, i] - u[k - 2, i], 2 * F[k - 1, i] - F[k - 2, i]
        predict(known, A, mean, u[k], F[k], inverse)
        if solve_balance(functions, constants, omega[k], known, A, mean, u[k], F[k], inverse):
            return True
    u[k] = known if k == 0 else u[k - 1]
    inverse[:] = np.eye(len(known))
    return solve_balance(functions, constants, omega[k], known, A, mean, u[k], F[k], inverse)


@njit(cache=True)
def put_compliance(flexibility: Complex, shapes: Complex, unit_response: Complex, A: Complex) -> None:
    """Put the compliance of the places to a force of the same instant into A (place, place)."""
    for i in range(len(A)):
        for j in range(len(A)):
            A[i, j] = flexibility[i, j]
            for mode in range(len(unit_response)):
                A[i, j] += shapes[i, mode] * unit_response[mode, j]


@njit(cache=True)
def halfway_weights(k: int, A: Complex, F: Reals, u: Reals) -> tuple[float, float, float, float]:
    """Return the weights of the force halfway to turn k + 1, of F and u known up to turn k."""
    return SMOOTH if k > 1 and not _is_stiff(A, F[k - 1 : k + 1], u[k - 1 : k + 1]) else STRAIGHT


@njit(cache=True)
def put_unit_response(
    step: Complex, phases: Complex, participation: Complex, later: Complex, weight: float, unit_response: Complex
) -> None:
    """Put the modes' response to a unit of force at the next turn into `unit_response` (mode, place)."""
    middle, end = phases
    ahead = end.conjugate() * middle * weight / 2
    for i in range(unit_response.shape[1]):
        for mode in range(len(unit_response)):
            unit_response[mode, i] = 0
        add_product(step[2], participation[:, i], ahead, unit_response[:, i])
        add_product(step[2], later[:, i], ahead, unit_response[:, i])
        add_product(step[3], later[:, i], 1.0, unit_response[:, i])


@njit(cache=True)
def add_product(A: Complex, x: Complex, factor: complex, y: Complex) -> None:
    """Add `factor` A x to the vector y."""
    for i in range(len(A)):
        total = 0j
        for j in range(len(x)):
            total += A[i, j] * x[j]
        y[i] += factor * total


@njit(cache=True)
def _put_steady_start(
    L: Complex, force: Complex, participation: Complex, free: Complex, unit_response: Complex
) -> None:
    """Put the steady state under the loads into `free` (mode,), under unit forces into `unit_response` (mode, place).

    In general `free` is the state at a turn without the force of that very turn, `unit_response` the part by a unit.
    """
    at_rest, work = np.empty((2, *L.shape), dtype=np.complex128)
    invert(L, at_rest, work)
    add_product(at_rest, force, -1.0, free)
    for i in range(participation.shape[1]):
        add_product(at_rest, participation[:, i], -1.0, unit_response[:, i])


@njit(cache=True)
def _put_free_motion(static: Reals, by_loads: Complex, shapes: Complex, free: Complex, known: Reals) -> None:
    """Put the motion of the places without the force of the turn into `known` (part,), no overtones."""
    places = len(static)
    for i in range(places):
        Q = by_loads[i]
        for mode in range(len(free)):
            Q += shapes[i, mode] * free[mode]
        known[i], known[places + i], known[2 * places + i] = static[i], Q.real, Q.imag


@njit(cache=True)
def _put_free_response(
    k: int,
    step: Complex,
    phases: Complex,
    a: Complex,
    rate: Complex,
    force_mid: Complex,
    force: Complex,
    participation: Complex,
    forces: Complex,
    weights: tuple[float, float, float, float],
    free: Complex,
) -> None:
    """Put the state at turn k + 1 without the force at the places there into `free`; `rate` is all forces at k."""
    middle, end = phases
    halfway, halfway_force = np.empty(forces.shape[1], dtype=np.complex128), force_mid.copy()
    for i in range(len(halfway)):
        halfway[i] = (weights[1] * forces[0, i] + weights[2] * forces[1, i] + weights[3] * forces[2, i]) / 2
    add_product(participation[k], halfway, 1.0, halfway_force)  # halfway it is the mean of both turns
    add_product(participation[k + 1], halfway, 1.0, halfway_force)
    for i in range(len(free)):
        free[i] = 0
    add_product(step[0], a, end.conjugate(), free)
    add_product(step[1], rate, end.conjugate(), free)
    add_product(step[2], halfway_force, end.conjugate() * middle, free)
    add_product(step[3], force, 1.0, free)


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
