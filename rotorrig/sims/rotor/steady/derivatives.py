"""Steady-state unbalance response and its derivatives along directions of the matrices."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model import Complex, Direction, Load, RotorModel, patterns, probe_changes, unbalance_loads
from rotorrig.sims.rotor.steady.conjugate_solve import solve_with_conjugate
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, load_columns

Reals = NDArray[np.float64]


class Derivatives(NamedTuple):
    """The response to each load, and what a unit of each direction adds."""

    z: Complex  # (row, probe, load) m, or m per kg m
    by: Complex  # (direction, row, probe, load)


def steady_derivatives(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Sequence[str] = (),
    loads: Sequence[Load] = (),
    directions: Sequence[Direction],
    order: float = 1.0,
) -> Derivatives:
    """Return the steady response at `order` to 1 kg m at each place of `unbalance`, then to each load, by directions.

    At the speeds `omega` [rad/s]. dz = dP q - P Z^-1 dZ q, q = Z^-1 F, P the
    probes' rows. Raises as harmonic.load_columns, ValueError on a load of
    another order.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    every = (*unbalance_loads(model, unbalance, order=order), *loads)
    patterns(model, every, order=order)  # asked for its checks
    q = load_columns(replace(model, probes=np.eye(model.dof)), omega, every)  # (speed, dof, load)
    O = omega[:, None, None]  # noqa: E741
    w = order * O
    forces = [_force(d, q, O, w) for d in directions]
    if order == 1:
        forces = [F + (d.T / 2 @ q.conj() if np.ndim(d.T) else 0) for F, d in zip(forces, directions, strict=True)]
    Z = dynamic_stiffness(model, omega, order=order)
    if order == 1 and model.added.T is not None:
        by = [-model.probes @ solve_with_conjugate(Z, model.added.T / 2, F) for F in forces]
    else:
        left = np.linalg.solve(Z.swapaxes(1, 2), np.broadcast_to(model.probes.T, (len(omega), *model.probes.T.shape)))
        by = [-left.swapaxes(1, 2) @ F for F in forces]
    z = model.probes @ q
    seen = probe_changes(directions, len(model.probes), model.dof)[:, None] @ q
    return Derivatives(z, np.array(by).reshape(len(directions), *z.shape) + seen)


def _force(d: Direction, q: Complex, O: Reals, w: Reals) -> Complex:  # noqa: E741
    """Return dZ q, (speed, dof, load), of the motion q at shaft speeds O and frequencies w, (speed, 1, 1) rad/s."""
    parts = ((d.K, 1.0), (d.H, O), (d.S, O**2), (d.M, -(w**2)), (d.C, 1j * w), (d.G, 1j * w * O))
    return sum((by * (matrix @ q) for matrix, by in parts if np.any(matrix)), np.zeros_like(q))
