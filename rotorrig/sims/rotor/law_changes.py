"""What a change makes of a force law: of the force on a motion, and of the response to its harmonics."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.describing import OVERTONES, forces, phasor, slopes
from rotorrig.sims.rotor.directions import Direction
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.harmonic import load_columns
from rotorrig.sims.rotor.loads import Load

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


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


def by_changed(laws: Sequence[ForceLaw], change: LawChange, omega: Reals, u: Reals, F: Reals) -> tuple[Reals, Reals]:
    """Return what a change of the laws does to the forces on the same motions, (n, part), and to where these rest.

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
    """Return the derivatives of the steady response to an overtone of the force, 2 or 3, (n, probe, change).

    The motions u (n, part) at speeds (n,) change by `du` (n, part, change).
    """
    places = 2 * len(laws)
    more = places * (1 + 2 * OVERTONES[-1]) - u.shape[1]  # that do not move where the force is found without overtones
    u, du = np.pad(u, ((0, 0), (0, more))), np.pad(du, ((0, 0), (0, more), (0, 0)))
    F = forces(laws, omega, u)
    dF = slopes(laws, omega, u) @ du
    for i, change in enumerate(changes):
        if change.laws is not None:
            dF[..., i] += (forces(change.laws, omega, u) - F) / change.step
    units = [Load(pattern=row.astype(complex), law="constant", order=order) for law in laws for row in law.rows]
    found: Complex = load_columns(model, omega, units) @ phasor(dF, places, order)
    return found
