"""Steady response with force laws, for tables without times: at every speed from the motion at the one before.

So the order of the speeds decides which branch is followed where there are several: rising for a run-up, falling for a
coast-down; past a fold it jumps to the other.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig import DataError
from rotorrig.rig.config import RPM
from rotorrig.sims.rotor.model import Load, RotorModel, matrices
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import (
    COMPLEX,
    REALS,
    call_kernel,
    forces,
    overtones,
    pack_laws,
    phasor,
    slopes,
    solve_balance,
)
from rotorrig.sims.rotor.nonlinear.law_changes import (
    LawChange,
    LawDerivatives,
    columns_of_laws,
    differentiate_forces,
    overtone_derivatives,
    solve_tangent,
)
from rotorrig.sims.rotor.nonlinear.swept_motion import overtone_compliance, place_rows
from rotorrig.sims.rotor.steady import load_columns, steady_derivatives

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

ELSEWHERE = (1.0, 0.3, -0.3, -1.0, -3.0, 3.0, 0.1)  # of the response without the law: where to begin past a fold
CONTINUE = (REALS[2], REALS[1], REALS[1], COMPLEX[2], COMPLEX[4], REALS[2])


def steady_with_law(
    model: RotorModel,
    omega: ArrayLike,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    orders: Sequence[int] = (1,),
) -> Complex:
    """Return the steady response at the speeds [rad/s], in the order given, (speed, probe, order) m.

    Arguments and result as in swept_with_law. Raises as load_columns, DataError at a speed where the force does not
    converge.
    """
    omega, amounts = np.atleast_1d(np.asarray(omega, dtype=float)), np.asarray(amounts, dtype=complex)
    at, probes = place_rows(laws), len(model.probes)
    first = _linear(_with_place_probes(model, at), omega, loads, amounts, at, 1)
    u = _motions(model, omega, first[0][:, probes:], first[1][:, probes:], laws)
    F = forces(laws, omega, u)
    by_order = []
    for order in orders:
        same = first[0][:, :probes], first[1][:, :probes]
        linear, by_force = same if order == 1 else _linear(model, omega, loads, amounts, at, order)
        of_order = overtones(laws, omega, u, F, order)
        by_order.append((linear if order else 0) + np.einsum("spi,si->sp", by_force, of_order))
    return np.stack(by_order, axis=-1)


def steady_law_derivatives(
    model: RotorModel,
    omega: ArrayLike,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    changes: Sequence[LawChange],
    orders: Sequence[int] = (1,),
) -> LawDerivatives:
    """Return the steady response of 1X under loads of order 1 and the laws, and its derivatives by `changes`.

    Arguments and errors as those of steady_with_law, result as of swept_law_derivatives.
    """
    omega, amounts = np.atleast_1d(np.asarray(omega, dtype=float)), np.asarray(amounts, dtype=complex)
    at, n = place_rows(laws), len(model.probes)
    directions = [c.direction for c in changes if c.direction is not None]
    columns = steady_derivatives(
        _with_place_probes(model, at), omega, loads=[*loads, *_unit_loads(at, 1)], directions=directions
    )
    places = columns.z[:, n:]
    u = _motions(model, omega, places[..., : len(loads)] @ amounts, places[..., len(loads) :], laws)
    F = forces(laws, omega, u)
    weights = np.concatenate([np.broadcast_to(amounts, (len(omega), len(amounts))), phasor(F, len(at))], axis=1)
    z, by_direction = columns.z, iter(columns.by)
    direct = np.zeros((*z.shape[:2], len(changes)), dtype=complex)  # as long as the forces stay
    du, dF = np.zeros((2, *u.shape, len(changes)))
    flexibility = _static_flexibility(model, at)
    for i, change in enumerate(changes):
        if change.direction is not None:
            direct[..., i] += np.einsum("spl,sl->sp", next(by_direction), weights)
            du[:, : len(at), i] -= F[:, : len(at)] @ (flexibility.T @ np.real(change.direction.K) @ flexibility).T
        if change.amounts is not None:
            direct[..., i] += z[..., : len(loads)] @ change.amounts
    law_columns = columns_of_laws(changes)
    dF[..., law_columns], static = differentiate_forces(laws, [changes[i] for i in law_columns], omega, u, F)
    du[:, : len(at), law_columns] += static
    du[:, len(at) : 3 * len(at)] += np.concatenate([direct[:, n:].real, direct[:, n:].imag], axis=1)
    A = np.concatenate([z[:, None, n:, len(loads) :], overtone_compliance(model, omega, laws)], axis=1)
    du, dF = solve_tangent(A, at @ flexibility, slopes(laws, omega, u), du, dF)
    by = {n: overtone_derivatives(model, laws, changes, omega, u, F, du, dF, order=n) for n in orders if n > 1}
    by[1] = direct[:, :n] + z[:, :n, len(loads) :] @ phasor(dF, len(at))
    return LawDerivatives(np.einsum("spl,sl->sp", z[:, :n], weights), by)


def _motions(model: RotorModel, omega: Reals, linear: Complex, by_force: Complex, laws: Sequence[ForceLaw]) -> Reals:
    """Solve for the places' motion at every speed, (speed, part), from that without the laws and under a unit force.

    Raises DataError where it does not converge.
    """
    at = place_rows(laws)
    functions, constants = pack_laws(laws)
    A = np.concatenate([by_force[:, None], overtone_compliance(model, omega, laws)], axis=1)
    u, solved = call_kernel(
        _continue_over_speed,
        CONTINUE,
        functions,
        constants,
        np.concatenate([law.static for law in laws]).astype(float),
        omega,
        np.ascontiguousarray(linear),
        A,
        at @ _static_flexibility(model, at),
    )
    if not solved.all():
        where = omega[np.argmin(solved)] * RPM
        raise DataError(f"law: its force is not found at {where:.6g} rpm, want a smoother or weaker one")
    motions: Reals = u
    return motions


def _with_place_probes(model: RotorModel, at: Reals) -> RotorModel:
    """Return the model with the places' rows after its probes."""
    return replace(model, probes=np.concatenate([model.probes, at]))


def _static_flexibility(model: RotorModel, at: Reals) -> Reals:
    """Return the static deflection under a unit of force at every place, (dof, place) m/N."""
    return np.linalg.solve(matrices(model).K, at.T).astype(float)


def _unit_loads(at: Reals, order: int) -> list[Load]:
    return [Load(row.astype(complex), "constant", order) for row in at]


def _linear(
    model: RotorModel, omega: Reals, loads: Sequence[Load], amounts: Complex, at: Reals, order: int
) -> tuple[Complex, Complex]:
    """Return the response to the loads of that order, (speed, probe), and to 1 N at each row, (.., probe, row)."""
    same = [i for i, load in enumerate(loads) if load.order == order]
    every = [*(loads[i] for i in same), *_unit_loads(at, order)]
    columns = load_columns(model, omega, every)
    return columns[..., : len(same)] @ amounts[same], columns[..., len(same) :]


@njit(cache=True)
def _continue_over_speed(
    functions: tuple[Callable, ...],
    constants: Reals,
    static: Reals,
    omega: Reals,
    known: Complex,
    A: Complex,
    mean: Reals,
) -> tuple[Reals, NDArray[np.bool_]]:
    """Solve for the places' motion at every speed, (speed, part), from that before it; and where it converged."""
    speeds, places = known.shape
    size = (1 + 2 * A.shape[1]) * places
    u, solved = np.zeros((speeds, size)), np.zeros(speeds, dtype=np.bool_)
    right, F, inverse = np.zeros(size), np.empty(size), np.eye(size)
    for k in range(speeds):
        for i in range(places):
            right[i] = static[i]
            right[places + i], right[2 * places + i] = known[k, i].real, known[k, i].imag
        for i in range(size):
            u[k, i] = u[k - 1, i] if k else right[i]
        solved[k] = solve_balance(functions, constants, omega[k], right, A[k], mean, u[k], F, inverse)
        for part in ELSEWHERE:
            if solved[k]:
                break
            inverse[:] = np.eye(size)
            for i in range(size):
                u[k, i] = right[i] * (1.0 if i < places else part)
            solved[k] = solve_balance(functions, constants, omega[k], right, A[k], mean, u[k], F, inverse)
    return u, solved
