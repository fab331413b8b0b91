"""Derivatives of a swept response under force laws, by changes of the rotor, its loads or the laws.

At 1X they are those of the time stepping itself, the force solved for anew under every change. Above, the change of
the force's harmonic, and that of the rotor, is taken to act as in steady motion at the speed in the middle of a row.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model import Load, RotorModel
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import slopes
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange, LawDerivatives, overtone_derivatives, solve_tangent
from rotorrig.sims.rotor.nonlinear.law_stepping_tangent import step_tangent
from rotorrig.sims.rotor.nonlinear.swept_motion import LawMotion, LawSweep, quasistatic_average
from rotorrig.sims.rotor.nonlinear.tangent_forcing import TangentForcing, compute_forcing
from rotorrig.sims.rotor.swept import TrackedRows, project_to_probes

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


def swept_law_derivatives(
    model: RotorModel,
    rows: TrackedRows,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    changes: Sequence[LawChange],
    orders: Sequence[int] = (1,),
) -> LawDerivatives:
    """Return the response of 1X under loads of order 1 and the laws, and its derivatives by `changes`.

    Those at orders 2 and 3 are of the laws' forces alone. Arguments and errors as those of swept_with_law.
    """
    sweep = LawSweep(model, rows, loads, np.asarray(amounts, dtype=complex), laws)
    motion = sweep.solve()
    forcing = compute_forcing(sweep, motion, changes)
    slope = slopes(laws, rows.turns.omega, motion.u)
    a, rate, dF, compliance = step_tangent(
        sweep.envelope.operator,
        sweep.envelope.steps,
        sweep.envelope.phases,
        sweep.participation,
        sweep.shapes,
        sweep.flexibility,
        sweep.mean,
        motion.overtones,
        motion.u,
        motion.F,
        slope,
        forcing.force,
        forcing.force_mid,
        forcing.motion,
        forcing.law_force,
        forcing.law_columns,
    )
    others = sweep.modes.others[:, : sweep.probes]
    by = project_to_probes(sweep.modes.shape[..., : sweep.probes], rows.averages(a, rate, powers=len(others)))
    by = by + quasistatic_average(rows, others[..., sweep.loads :], dF) + forcing.at_probes
    higher = [order for order in orders if order > 1]
    overtones = _overtone_derivatives(sweep, motion, forcing, slope, compliance, changes, higher) if higher else {}
    return LawDerivatives(sweep.at_probes(motion), {1: by} | overtones)


def _overtone_derivatives(
    sweep: LawSweep,
    motion: LawMotion,
    forcing: TangentForcing,
    slope: Reals,
    compliance: Complex,
    changes: Sequence[LawChange],
    orders: Sequence[int],
) -> dict[int, Complex]:
    """Return the derivatives of the response at orders above 1, (row, probe, change) each."""
    rows = sweep.rows
    middle = rows.turn_index[:, rows.turn_index.shape[1] // 2]
    omega, u, F = rows.turns.omega[middle], motion.u[middle], motion.F[middle]
    known, law_force = np.zeros((2, *u.shape, len(changes)))
    known[:, : forcing.motion.shape[1]] = forcing.motion[middle]
    law_force[..., forcing.law_columns] = forcing.law_force[middle]
    A = np.concatenate([compliance[middle, None], motion.overtones[middle]], axis=1)
    du, dF = solve_tangent(A, sweep.mean, slope[middle], known, law_force)
    return {n: overtone_derivatives(sweep.model, sweep.laws, changes, omega, u, F, du, dF, order=n) for n in orders}
