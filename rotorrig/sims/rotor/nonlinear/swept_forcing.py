"""What changes of the rotor, its loads or its force laws do to a march, as long as forces and motion stay as found."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Direction, matrices
from rotorrig.sims.rotor.nonlinear.changes import LawChange, by_changed, changing_laws
from rotorrig.sims.rotor.nonlinear.harmonic_balance import phasor
from rotorrig.sims.rotor.nonlinear.swept_motion import LawPassage, Marched, at_once
from rotorrig.sims.rotor.swept import Passage, passage_derivatives, polynomial

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True)
class Forcing:
    """What drives the derivatives, a column for each change."""

    force: Complex  # (turn, mode, column) on the passed modes, as long as the force at the places stays
    force_mid: Complex  # (turn - 1, mode, column) halfway in time
    motion: Reals  # (turn, 3 place, column) of the places' mean and first harmonic, as long as modes and force stay
    lawful: Index  # (law column,) the columns that change the laws
    reaction: Reals  # (turn, part, law column) of the force there, as long as the motion stays
    at_rows: Complex  # (row, probe, column) of what the rows show, as long as modes and force stay


def forcing(places: LawPassage, found: Marched, changes: Sequence[LawChange]) -> Forcing:
    """Return what the changes do to the motion found."""
    (turns, modes), size, count = found.a.shape, found.u.shape[1], len(changes)
    lawful = changing_laws(changes)
    driving = Forcing(
        force=np.zeros((turns, modes, count), dtype=complex),
        force_mid=np.zeros((turns - 1, modes, count), dtype=complex),
        motion=np.zeros((turns, 3 * len(places.at), count)),
        lawful=lawful,
        reaction=np.zeros((turns, size, len(lawful))),
        at_rows=np.zeros((len(places.rows.seen), places.probes, count), dtype=complex),
    )
    directions = {i: c.direction for i, c in enumerate(changes) if c.direction is not None}
    if directions:
        _by_directions(places, found, directions, driving)
    amounts = {i: c.amounts for i, c in enumerate(changes) if c.amounts is not None}
    if amounts:
        _by_amounts(places, amounts, driving)
    own, omega = [changes[i] for i in lawful], places.rows.turns.omega
    driving.reaction[:], rest = by_changed(places.laws, own, omega, found.u, found.F)
    driving.motion[:, : len(rest), lawful] += rest
    return driving


def _by_directions(places: LawPassage, found: Marched, directions: dict[int, Direction], driving: Forcing) -> None:
    change = passage_derivatives(places.spectra, places.pattern, list(directions.values()))
    which, F, probes = list(directions), phasor(found.F, len(places.at)), places.probes
    force, force_mid = _forced(places, F, change.g.swapaxes(1, 2))
    places.envelope.add_push(change, found.a[..., None], found.rate[..., None], force, force_mid)
    driving.force[..., which], driving.force_mid[..., which] = force, force_mid
    seen = polynomial(places.rows.power, np.ascontiguousarray(change.shape[..., probes:]))
    others = _at_turns(places, F, change.others[:, :, probes:].swapaxes(1, 2))
    _add_phasor(driving.motion, which, np.einsum("tdmp,tm->tpd", seen, found.a) + others)
    count = len(places.at)
    lean = np.linalg.solve(matrices(places.model).K, places.at.T)  # (dof, place)
    for i, direction in directions.items():
        driving.motion[:, :count, i] -= found.F[:, :count] @ (lean.T @ np.real(direction.K) @ lean).T
    driving.at_rows[..., which] = _seen_by_rows(places, found, change)


def _seen_by_rows(places: LawPassage, found: Marched, change: Passage) -> Complex:
    """Return what the rows show of the same motion and forces by changed modes, (row, probe, direction)."""
    rows, probes, loads = places.rows, places.probes, places.loads
    average = rows.averages(found.a, found.rate, powers=len(places.modes.others))  # (row, power, mode)
    by_modes = np.einsum("rqm,qdmp->rpd", average, change.shape[..., :probes], optimize=True)
    others = change.others[:, :, :probes]
    by_loads = places.drive.averaged(others[..., :loads]) @ places.amounts  # (direction, row, probe)
    flat = others[..., loads:].reshape(len(others), -1, len(places.at))
    by_force = at_once(rows, flat, phasor(found.F, len(places.at))[..., None]).reshape(len(rows.seen), -1, probes)
    return by_modes + np.moveaxis(by_loads, 0, -1) + by_force.swapaxes(1, 2)


def _by_amounts(places: LawPassage, changes: dict[int, Complex], driving: Forcing) -> None:
    which, probes, loads = list(changes), places.probes, places.loads
    amounts = np.stack(list(changes.values()), axis=-1)  # (load, column)
    force, force_mid = places.envelope.forces(places.modes.g[..., :loads], places.drive)
    driving.force[..., which] += force @ amounts
    driving.force_mid[..., which] += force_mid @ amounts
    _add_phasor(driving.motion, which, places.base @ amounts)
    driving.at_rows[..., which] += places.drive.averaged(places.modes.others[:, :probes, :loads]) @ amounts


def _forced(places: LawPassage, F: Complex, change: Complex) -> tuple[Complex, Complex]:
    """Return what loads and force do by a `change` (power, mode, direction, load and place) at the turns and halfway.

    (turn, mode, direction). Halfway the force is the mean of both turns.
    """
    pushing, drive = _of_pushing(places, change), places.drive
    at = _times(polynomial(places.rows.power, pushing), drive.at, F)
    return at, _times(polynomial(places.rows.power_mid, pushing), drive.mid, (F[:-1] + F[1:]) / 2)


def _at_turns(places: LawPassage, F: Complex, change: Complex) -> Complex:
    return _times(polynomial(places.rows.power, _of_pushing(places, change)), places.drive.at, F)


def _of_pushing(places: LawPassage, change: Complex) -> Complex:
    """Add up the loads of every law times their amounts: (..., law and place)."""
    by_law = np.zeros((*change.shape[:-1], places.drive.at.shape[1]), dtype=complex)
    for load, law in enumerate(places.drive.which):
        by_law[..., law] += change[..., load] * places.amounts[load]
    return np.concatenate([by_law, change[..., places.loads :]], axis=-1)


def _times(change: Complex, laws: Complex, F: Complex) -> Complex:
    """Return `change` (turn, .., direction, law and place) times the laws' values and the forces, summed."""
    return (change @ np.concatenate([laws, F], axis=1)[:, None, :, None])[..., 0]


def _add_phasor(du: Reals, which: Sequence[int], Q: Complex) -> None:
    """Add first harmonics (turn, place, column) to the columns `which`."""
    count = Q.shape[1]
    du[:, count : 2 * count, which] += Q.real
    du[:, 2 * count : 3 * count, which] += Q.imag
