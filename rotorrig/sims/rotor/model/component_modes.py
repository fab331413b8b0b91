"""A reduced model whose geometry may still be changed: Craig and Bampton's component modes of the spans between parts.

The rotor's coordinates are the motions x, y, a, b of the shaft at its disks, bearings and planes; between them it
follows as it bends under forces and moments at their places alone, and under a few patterns of force between them,
each the amount of one more coordinate (Craig, Bampton, AIAA J. 6, 1968, 1313, but for the patterns: the inertia of
the rotor's own lowest modes instead of modes of the shaft held fast, as they need a fifth as many coordinates). Both
are worked out anew for every geometry, by a solve in one plane. So the static response to loads at the parts is exact
whatever bearings, tilt stiffness, positions, hubs and diameter are, and the rows that read parts do not depend on them.
Of all these coordinates those are taken in which the mass is the unit matrix on the nameplate.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from rotorrig.sims.rotor.model.assembly import RotorModel, geometry_of, matrices, transform
from rotorrig.sims.rotor.model.bearing import with_coefficients
from rotorrig.sims.rotor.model.geometry import Geometry, bend_between, one_plane
from rotorrig.sims.rotor.model.reduction import holding_stiffness

BEARINGS = (1.0, 0.01, 100.0)  # times the stiffness given: with such bearings the rotor's modes are looked at,
LOWEST = 6  # so many of each


Matrix = NDArray[np.float64]


def condense_spans(model: RotorModel, *, modes: int = 6) -> RotorModel:
    """Return an assembled model on the coordinates of its parts and `modes` in either plane between them.

    configs/rk4.toml with hubs, 28 of 144 DOF, against the full model with every position, hub, tilt stiffness and the
    diameter at three prior sigmas at once: within 2e-6 of the peak to 4000 rpm for a spring bearing of 1e3 to 1e6 N/m;
    2e-5 with 5 modes, 6e-5 with 4. Raises ValueError if anything has been added to the model.
    """
    if any(A is not None for A in model.added) or len(model.appended):
        raise ValueError("the model has matrices or coordinates added to it, want it as assembled")
    geometry = geometry_of(model)
    held = _held_coordinates(model, geometry)
    plane = one_plane(geometry, geometry.shape)
    inertia, between = plane.mass + plane.tilt, np.setdiff1d(geometry.held, held)
    own = np.ix_(between, between)
    count = min(modes, len(between))
    inner = _inertia_forces(model, geometry, inertia[between], plane.stiffness[own])[:, :count]
    V = bend_between(plane.stiffness, held, inner)
    basis = _coordinates(geometry.basis[:, held], count)
    nodes = np.concatenate([V @ basis[0], V @ basis[1]])
    condensed = transform(model, geometry.basis.reshape(len(nodes), -1).T @ nodes)
    condensed = replace(condensed, geometry=replace(geometry, held=held, inner=inner, basis=basis))
    root = linalg.cholesky(matrices(_held_fast(condensed)).M)  # upper: M = root^T root
    return transform(condensed, linalg.solve_triangular(root, np.eye(len(root))))


def _coordinates(held: Matrix, count: int) -> Matrix:
    """Return a plane's coordinates from the rotor's, (2 plane, coordinate, dof): `held` ones and `count` more.

    What a rigid bearing holds, a row of zeros in `held` (2 plane, coordinate, before), is none of the rotor's.
    """
    free = np.pad(np.any(held, axis=2), ((0, 0), (0, count)), constant_values=True)
    basis: Matrix = np.eye(free.size)[:, free.ravel()].reshape(*free.shape, -1)
    return basis


def _held_coordinates(model: RotorModel, geometry: Geometry) -> NDArray[np.intp]:
    """Return a plane's coordinates w and a of every node at which a disk, a bearing or a plane is."""
    rows = [part.rows for kind in (model.disks, model.planes, model.tilts) for part in kind]
    reads = np.abs(geometry.basis @ np.vstack(rows).T).sum(axis=(0, 2)) > 0
    nodes = np.flatnonzero(reads.reshape(-1, 2).any(axis=1))
    return np.sort(np.concatenate([2 * nodes, 2 * nodes + 1]))


def _inertia_forces(model: RotorModel, geometry: Geometry, inertia: Matrix, stiffness: Matrix) -> Matrix:
    """Return patterns of force between the parts, those that bend the shaft there most first, (coordinate, pattern).

    The inertia of the rotor's lowest modes, with bearings as given, soft and stiff, each of the same energy.
    """
    nodes = []
    for factor in BEARINGS:
        system = matrices(_held_fast(model, factor))
        values, shapes = linalg.eigh(system.K, system.M, subset_by_index=[0, min(LOWEST, model.dof) - 1])
        energy = np.maximum(values, np.finfo(float).eps * np.abs(system.K / system.M.max()).max())  # rounding
        nodes += list(geometry.basis @ (shapes / np.sqrt(energy)))
    root = linalg.cholesky(stiffness, lower=True)
    forces = linalg.solve_triangular(root, inertia @ np.hstack(nodes), lower=True)
    patterns: Matrix = root @ np.linalg.svd(forces, full_matrices=False)[0]
    return patterns


def _held_fast(model: RotorModel, factor: float = 1.0) -> RotorModel:
    """Return the model in bearings of constant stiffness that hold it, as given or times a factor."""
    held = [with_coefficients(b, factor * holding_stiffness(b), np.zeros((2, 2))) for b in model.bearings]
    return replace(model, bearings=tuple(held))
