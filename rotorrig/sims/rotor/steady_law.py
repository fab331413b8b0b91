"""The steady response with force laws, for tables without times: at every speed from the motion at the one before.

So the order of the speeds decides which branch is followed where there are several: rising for a run-up, falling for a
coast-down; past a fold it jumps to the other.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig.errors import DataError
from rotorrig.rig.units import RPM
from rotorrig.sims.rotor.assembly import RotorModel, matrices
from rotorrig.sims.rotor.describing import COMPLEX, OVERTONE, REALS, called, overtone, pointers, settle
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.harmonic import load_columns
from rotorrig.sims.rotor.loads import Load

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

ELSEWHERE = (1.0, 0.3, -0.3, -1.0, -3.0, 3.0, 0.1)  # of the response without the law: where to begin past a fold
CONTINUE = (REALS[2], REALS[1], REALS[1], COMPLEX[2], COMPLEX[3], REALS[2])


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

    The arguments and what is returned are as in swept_law.swept_with_law. Raises as harmonic.load_columns, DataError at
    a speed where the force is not found.
    """
    omega, amounts = np.atleast_1d(np.asarray(omega, dtype=float)), np.asarray(amounts, dtype=complex)
    at = np.concatenate([law.rows for law in laws])
    whole = replace(model, probes=np.concatenate([model.probes, at]))
    functions, constants = pointers(laws)
    static = np.concatenate([law.static for law in laws]).astype(float)
    mean = at @ np.linalg.solve(matrices(model).K, at.T)
    linear, by_force = _linear(whole, omega, loads, amounts, at, 1)
    probes = len(model.probes)
    u, solved = called(
        _continued,
        CONTINUE,
        functions,
        constants,
        static,
        omega,
        np.ascontiguousarray(linear[:, probes:]),
        np.ascontiguousarray(by_force[:, probes:]),
        mean,
    )
    if not solved.all():
        where = omega[np.argmin(solved)] * RPM
        raise DataError(f"law: its force is not found at {where:.6g} rpm, want a smoother or weaker one")
    found = []
    for order in orders:
        linear, by_force = _linear(model, omega, loads, amounts, at, order)
        F = called(overtone, OVERTONE, functions, constants, omega, u, order)
        found.append((linear if order else 0) + np.einsum("spi,si->sp", by_force, F))
    return np.stack(found, axis=-1)


def _linear(
    model: RotorModel, omega: Reals, loads: Sequence[Load], amounts: Complex, at: Reals, order: int
) -> tuple[Complex, Complex]:
    """Return the response to the loads of that order, (speed, probe), and to 1 N at each row, (.., probe, row)."""
    same = [i for i, load in enumerate(loads) if load.order == order]
    every = [*(loads[i] for i in same), *(Load(row.astype(complex), "constant", order) for row in at)]
    columns = load_columns(model, omega, every)
    return columns[..., : len(same)] @ amounts[same], columns[..., len(same) :]


@njit(cache=True)
def _continued(
    functions: tuple[Callable, ...],
    constants: Reals,
    static: Reals,
    omega: Reals,
    known: Complex,
    A: Complex,
    mean: Reals,
) -> tuple[Reals, NDArray[np.bool_]]:
    """Return the places' motion at every speed, (speed, 3 place), and where it was found, (speed,)."""
    speeds, places = known.shape
    u, solved = np.zeros((speeds, 3 * places)), np.zeros(speeds, dtype=np.bool_)
    right, F, inverse = np.empty(3 * places), np.empty(3 * places), np.eye(3 * places)
    for k in range(speeds):
        for i in range(places):
            right[i] = static[i]
            right[places + i], right[2 * places + i] = known[k, i].real, known[k, i].imag
        for i in range(3 * places):
            u[k, i] = u[k - 1, i] if k else right[i]
        solved[k] = settle(functions, constants, omega[k], right, A[k], mean, u[k], F, inverse)
        for part in ELSEWHERE:
            if solved[k]:
                break
            inverse[:] = np.eye(3 * places)
            for i in range(3 * places):
                u[k, i] = right[i] * (1.0 if i < places else part)
            solved[k] = settle(functions, constants, omega[k], right, A[k], mean, u[k], F, inverse)
    return u, solved
