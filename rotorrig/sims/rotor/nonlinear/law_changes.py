"""Derivatives of the forces of laws, and of the response to their harmonics, by changes of rotor, loads or laws."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Direction, Load, RotorModel
from rotorrig.sims.rotor.nonlinear.force_harmonics import OVERTONES
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import forces, overtones, phasor, slopes
from rotorrig.sims.rotor.steady import steady_derivatives

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class LawChange:
    """Change of matrices, amounts or laws per unit of one real unknown; None: unchanged."""

    direction: Direction | None = None
    amounts: Complex | None = None  # (load,)
    laws: tuple[ForceLaw, ...] | None = None  # as they are after `step` of it, at the same places
    step: float = 1.0


class LawDerivatives(NamedTuple):
    """The response of 1X, (row, probe) m, and derivatives by order, (row, probe, change)."""

    z: Complex
    by: dict[int, Complex]


def columns_of_laws(changes: Sequence[LawChange]) -> NDArray[np.intp]:
    """Return the columns (numbers) of those changes that change the laws."""
    return np.array([i for i, change in enumerate(changes) if change.laws is not None], dtype=np.intp)


def differentiate_forces(
    laws: Sequence[ForceLaw], changes: Sequence[LawChange], omega: Reals, u: Reals, F: Reals
) -> tuple[Reals, Reals]:
    """Differentiate the forces on the same motions, (n, part, change), and the places' static positions, by the laws.

    The positions are (place, change) m. Many changes move few constants, as all of a rotor's stiffnesses move how its
    journal lies: a force is evaluated anew for every constant, not for every change.
    """
    dF, rest = np.zeros((*F.shape, len(changes))), np.zeros((2 * len(laws), len(changes)))
    for n, law in enumerate(laws):
        changed = [change.laws[n] for change in changes if change.laws is not None]
        steps = np.array([own.constants - law.constants for own in changed]).reshape(len(changes), len(law.constants))
        for i, change in enumerate(changes):
            rest[2 * n : 2 * n + 2, i] = (changed[i].static - law.static) / change.step
        own_parts = _parts_of(n, laws, u.shape[1])
        there = np.ascontiguousarray(u[:, own_parts])
        for j in np.flatnonzero(steps.any(axis=0)):
            step = steps[np.argmax(np.abs(steps[:, j])), j]
            moved = replace(law, constants=law.constants + step * (np.arange(len(law.constants)) == j))
            by_constant = (forces((moved,), omega, there) - F[:, own_parts]) / step
            dF[:, own_parts] += by_constant[..., None] * (steps[:, j] / [change.step for change in changes])
    return dF, rest


def _parts_of(n: int, laws: Sequence[ForceLaw], size: int) -> NDArray[np.intp]:
    """Return which of the `size` parts of a motion are those of law `n`, on which alone its force depends."""
    places = 2 * len(laws)
    return np.array([block + 2 * n + axis for block in range(0, size, places) for axis in range(2)], dtype=np.intp)


def solve_tangent(A: Complex, mean: Reals, slope: Reals, known: Reals, dF: Reals) -> tuple[Reals, Reals]:
    """Solve du = known + A (slope du + dF); return du and slope du + dF, (n, part, change).

    A (n, harmonic, place, place) is the compliance to each harmonic of the force, `mean` (place, place) to its mean.
    """
    places = len(mean)
    whole = np.zeros_like(slope)
    whole[:, :places, :places] = mean
    for h in range(A.shape[1]):
        re, im = (slice(part * places, (part + 1) * places) for part in (2 * h + 1, 2 * h + 2))
        whole[:, re, re] = whole[:, im, im] = A[:, h].real
        whole[:, re, im], whole[:, im, re] = -A[:, h].imag, A[:, h].imag
    du = np.linalg.solve(np.eye(whole.shape[1]) - whole @ slope, known + whole @ dF).astype(float)
    return du, slope @ du + dF


def overtone_derivatives(
    model: RotorModel,
    laws: Sequence[ForceLaw],
    changes: Sequence[LawChange],
    omega: Reals,
    u: Reals,
    F: Reals,
    du: Reals,
    dF: Reals,
    *,
    order: int,
) -> Complex:
    """Return the derivatives of the steady response to an overtone of the force, 2 or 3, (n, probe, change).

    The motions u (n, part) at speeds (n,) change by `du`, the forces F on them by `dF` (n, part, change).
    """
    places = 2 * len(laws)
    if u.shape[1] == 3 * places:  # the force was evaluated without overtones
        dF = _with_overtones(laws, changes, omega, u, du)
    units = [Load(pattern=row.astype(complex), law="constant", order=order) for law in laws for row in law.rows]
    directions = {i: c.direction for i, c in enumerate(changes) if c.direction is not None}
    answers = steady_derivatives(model, omega, loads=units, directions=list(directions.values()), order=order)
    by: Complex = answers.z @ phasor(dF, places, order)
    by[..., list(directions)] += np.einsum("cnpl,nl->npc", answers.by, overtones(laws, omega, u, F, order))
    return by


def _with_overtones(laws: Sequence[ForceLaw], changes: Sequence[LawChange], omega: Reals, u: Reals, du: Reals) -> Reals:
    """Return the change of all parts of the force on motions that have a mean and a first harmonic, (n, part, ..)."""
    more = 4 * len(laws) * (OVERTONES[-1] - 1)  # parts that do not move
    u, du = np.pad(u, ((0, 0), (0, more))), np.pad(du, ((0, 0), (0, more), (0, 0)))
    dF: Reals = slopes(laws, omega, u) @ du
    law_columns = columns_of_laws(changes)
    dF[..., law_columns] += differentiate_forces(
        laws, [changes[i] for i in law_columns], omega, u, forces(laws, omega, u)
    )[0]
    return dF
