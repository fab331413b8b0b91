"""Forcing of the tangent: changes of rotor, loads or laws, as long as forces and motion stay as solved."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Direction, matrices
from rotorrig.sims.rotor.nonlinear.harmonic_balance import phasor
from rotorrig.sims.rotor.nonlinear.law_changes import LawChange, columns_of_laws, differentiate_forces
from rotorrig.sims.rotor.nonlinear.swept_motion import LawMotion, LawSweep, quasistatic_average
from rotorrig.sims.rotor.swept import PassedModes, differentiate_passed_modes, polynomial

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True)
class TangentForcing:
    """Right-hand side of the tangent equations, a column for each change."""

    force: Complex  # (turn, mode, column) on the passed modes, as long as the force at the places stays
    force_mid: Complex  # (turn - 1, mode, column) halfway in time
    motion: Reals  # (turn, 3 place, column) of the places' mean and first harmonic, as long as modes and force stay
    law_columns: Index  # (law column,) the columns that change the laws
    law_force: Reals  # (turn, part, law column) of the force there, as long as the motion stays
    at_probes: Complex  # (row, probe, column) m, of the response, as long as modes and force stay


def compute_forcing(sweep: LawSweep, motion: LawMotion, changes: Sequence[LawChange]) -> TangentForcing:
    """Compute the forcing of the tangent about the solved motion."""
    (turns, modes), size, count = motion.a.shape, motion.u.shape[1], len(changes)
    law_columns = columns_of_laws(changes)
    forcing = TangentForcing(
        force=np.zeros((turns, modes, count), dtype=complex),
        force_mid=np.zeros((turns - 1, modes, count), dtype=complex),
        motion=np.zeros((turns, 3 * len(sweep.at), count)),
        law_columns=law_columns,
        law_force=np.zeros((turns, size, len(law_columns))),
        at_probes=np.zeros((len(sweep.rows.turn_index), sweep.probes, count), dtype=complex),
    )
    directions = {i: c.direction for i, c in enumerate(changes) if c.direction is not None}
    if directions:
        _by_directions(sweep, motion, directions, forcing)
    amounts = {i: c.amounts for i, c in enumerate(changes) if c.amounts is not None}
    if amounts:
        _by_amounts(sweep, amounts, forcing)
    own, omega = [changes[i] for i in law_columns], sweep.rows.turns.omega
    forcing.law_force[:], rest = differentiate_forces(sweep.laws, own, omega, motion.u, motion.F)
    forcing.motion[:, : len(rest), law_columns] += rest
    return forcing


def _by_directions(
    sweep: LawSweep, motion: LawMotion, directions: dict[int, Direction], forcing: TangentForcing
) -> None:
    change = differentiate_passed_modes(sweep.spectra, sweep.pattern, list(directions.values()))
    which, F, probes = list(directions), phasor(motion.F, len(sweep.at)), sweep.probes
    force, force_mid = _modal_forces(sweep, F, change.g.swapaxes(1, 2))
    sweep.envelope.add_operator_change(change, motion.a[..., None], motion.rate[..., None], force, force_mid)
    forcing.force[..., which], forcing.force_mid[..., which] = force, force_mid
    seen = polynomial(sweep.rows.power, np.ascontiguousarray(change.shape[..., probes:]))
    others = _at_turns(sweep, F, change.others[:, :, probes:].swapaxes(1, 2))
    _add_phasor(forcing.motion, which, np.einsum("tdmp,tm->tpd", seen, motion.a) + others)
    count = len(sweep.at)
    flexibility = np.linalg.solve(matrices(sweep.model).K, sweep.at.T)  # (dof, place)
    for i, direction in directions.items():
        forcing.motion[:, :count, i] -= motion.F[:, :count] @ (flexibility.T @ np.real(direction.K) @ flexibility).T
    forcing.at_probes[..., which] = _at_probes(sweep, motion, change)


def _at_probes(sweep: LawSweep, motion: LawMotion, change: PassedModes) -> Complex:
    """Return the change at the probes by changed modes, motion and forces being the same, (row, probe, direction)."""
    rows, probes, loads = sweep.rows, sweep.probes, sweep.loads
    average = rows.averages(motion.a, motion.rate, powers=len(sweep.modes.others))  # (row, power, mode)
    by_modes = np.einsum("rqm,qdmp->rpd", average, change.shape[..., :probes], optimize=True)
    others = change.others[:, :, :probes]
    by_loads = sweep.excitation.average(others[..., :loads]) @ sweep.amounts  # (direction, row, probe)
    flat = others[..., loads:].reshape(len(others), -1, len(sweep.at))
    by_force = quasistatic_average(rows, flat, phasor(motion.F, len(sweep.at))[..., None]).reshape(
        len(rows.turn_index), -1, probes
    )
    return by_modes + np.moveaxis(by_loads, 0, -1) + by_force.swapaxes(1, 2)


def _by_amounts(sweep: LawSweep, changes: dict[int, Complex], forcing: TangentForcing) -> None:
    which, probes, loads = list(changes), sweep.probes, sweep.loads
    amounts = np.stack(list(changes.values()), axis=-1)  # (load, column)
    force, force_mid = sweep.envelope.forces(sweep.modes.g[..., :loads], sweep.excitation)
    forcing.force[..., which] += force @ amounts
    forcing.force_mid[..., which] += force_mid @ amounts
    _add_phasor(forcing.motion, which, sweep.by_loads @ amounts)
    forcing.at_probes[..., which] += sweep.excitation.average(sweep.modes.others[:, :probes, :loads]) @ amounts


def _modal_forces(sweep: LawSweep, F: Complex, change: Complex) -> tuple[Complex, Complex]:
    """Return the modal forces by a `change` (power, mode, direction, load and place) at the turns and halfway.

    (turn, mode, direction). Halfway the force is the mean of both turns.
    """
    by_law, excitation = _sum_by_law(sweep, change), sweep.excitation
    at = _times(polynomial(sweep.rows.power, by_law), excitation.at, F)
    return at, _times(polynomial(sweep.rows.power_mid, by_law), excitation.mid, (F[:-1] + F[1:]) / 2)


def _at_turns(sweep: LawSweep, F: Complex, change: Complex) -> Complex:
    return _times(polynomial(sweep.rows.power, _sum_by_law(sweep, change)), sweep.excitation.at, F)


def _sum_by_law(sweep: LawSweep, change: Complex) -> Complex:
    """Add up the loads of every law times their amounts: (..., law and place)."""
    by_law = np.zeros((*change.shape[:-1], sweep.excitation.at.shape[1]), dtype=complex)
    for load, law in enumerate(sweep.excitation.which):
        by_law[..., law] += change[..., load] * sweep.amounts[load]
    return np.concatenate([by_law, change[..., sweep.loads :]], axis=-1)


def _times(change: Complex, laws: Complex, F: Complex) -> Complex:
    """Return `change` (turn, .., direction, law and place) times the laws' values and the forces, summed."""
    return (change @ np.concatenate([laws, F], axis=1)[:, None, :, None])[..., 0]


def _add_phasor(du: Reals, which: Sequence[int], Q: Complex) -> None:
    """Add first harmonics (turn, place, column) to the columns `which`."""
    count = Q.shape[1]
    du[:, count : 2 * count, which] += Q.real
    du[:, 2 * count : 3 * count, which] += Q.imag
