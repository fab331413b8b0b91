"""What a change makes of a force law: of the force on a motion, and of the response to its harmonics."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.describing import forces, overtones
from rotorrig.sims.rotor.directions import Direction
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.harmonic import load_columns
from rotorrig.sims.rotor.loads import Load

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

STEP = 1e-6  # of the motion, of differences of the force
TINY = 1e-15  # m


@dataclass(frozen=True, slots=True, kw_only=True)
class LawChange:
    """What a unit of one real unknown changes; None: nothing."""

    direction: Direction | None = None
    amounts: Complex | None = None  # (load,)
    laws: tuple[ForceLaw, ...] | None = None  # as they are after `step` of it, at the same places
    step: float = 1.0


class LawDerivatives(NamedTuple):
    """The response of 1X, (row, probe) m, and derivatives by order, (row, probe, change)."""

    z: Complex
    by: dict[int, Complex]


def slopes(laws: Sequence[ForceLaw], omega: Reals, u: Reals, F: Reals) -> Reals:
    """Return dF / du of the forces F on motions u at speeds (n,), (n, 3 place, 3 place): describing.forces."""
    return np.stack([(forces(laws, omega, moved) - F) / step for moved, step in _moved(u)], axis=-1)


def by_changed(laws: Sequence[ForceLaw], change: LawChange, omega: Reals, u: Reals, F: Reals) -> tuple[Reals, Reals]:
    """Return what a change of the laws does to the forces on the same motions, (n, 3 place), and to where these rest.

    The rest is (place,) m. Of a change that has laws.
    """
    assert change.laws is not None
    dF = (forces(change.laws, omega, u) - F) / change.step
    rest = np.concatenate([after.static - before.static for before, after in zip(laws, change.laws, strict=True)])
    return dF, rest / change.step


def overtone_derivatives(
    model: RotorModel,
    laws: Sequence[ForceLaw],
    changes: Sequence[LawChange],
    omega: Reals,
    u: Reals,
    du: Reals,
    *,
    order: int,
) -> Complex:
    """Return the derivatives of the steady response to a harmonic of the force above the first, (n, probe, change).

    The motions u (n, 3 place) at speeds (n,) change by `du` (n, 3 place, change).
    """
    F = overtones(laws, omega, u, order)
    slope = np.stack([(overtones(laws, omega, moved, order) - F) / step for moved, step in _moved(u)], axis=-1)
    dF = slope @ du  # (n, place, change)
    for i, change in enumerate(changes):
        if change.laws is not None:
            dF[..., i] += (overtones(change.laws, omega, u, order) - F) / change.step
    units = [Load(pattern=row.astype(complex), law="constant", order=order) for law in laws for row in law.rows]
    found: Complex = load_columns(model, omega, units) @ dF
    return found


def _moved(u: Reals) -> Iterator[tuple[Reals, Reals]]:
    """Yield the motions (n, 3 place) with one part after the other moved, and by how much, (n, 1)."""
    step = STEP * np.abs(u).max(axis=1, keepdims=True) + TINY
    for i in range(u.shape[1]):
        moved = u.copy()
        moved[:, i] += step[:, 0]
        yield moved, step
