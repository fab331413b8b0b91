"""Motion, curvature and static deflection of the shaft at any place, from a full or a reduced model."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from scipy.interpolate import CubicSpline

from rotorrig.sims.rotor.model import RotorModel, matrices
from rotorrig.sims.rotor.modes import static_solution, weight

Reals = NDArray[np.float64]

BELOW = 2 * np.pi * 100.0  # rad/s: the motions that matter are about as much strain as inertia at this frequency
DEPENDENT = 1e-8  # singular values below this part of the largest are rounding


def position_rows(model: RotorModel, z: float) -> Reals:
    """Return the rows that read x and y of the shaft at z [m], (2, dof): a cubic spline through the nodes."""
    return CubicSpline(model.z, model.centreline, axis=1)(z)


def curvature_rows(model: RotorModel, z: float) -> Reals:
    """Return the rows that read the curvatures x'' and y'' [1/m] of the shaft at z [m], (2, dof)."""
    return CubicSpline(model.z, model.centreline, axis=1)(z, 2)


def forward(rows: NDArray, rotation: int) -> NDArray[np.complex128]:
    """Return the pattern (dof,) of a unit load on x and y, `rows` (2, dof), that turns with the shaft: (1, -j)."""
    return rows[0] - 1j * rotation * rows[1]


def at_rest(model: RotorModel, gravity: str) -> Reals:
    """Return the coordinates (dof,) of the rotor under its own weight; `gravity` as in RigConfig."""
    return static_solution(model, matrices(model, 0.0).K, weight(model, gravity))


def pairwise_map(model: RotorModel, R: ArrayLike) -> NDArray:
    """Return the matrix (dof, dof) that does R (2, 2) to the pair x, y, and to the pair of slopes, all along the shaft.

    A reduced model does not know which of its coordinates are along x. But the shaft, alike in both planes, answers a
    push along x by a motion along x; the answers to a push at every node span all slow motions, and R is known on them.
    """
    K, M, beside = model.shaft.K, model.shaft.M, model.appended
    root = linalg.cholesky(K + BELOW**2 * M + np.trace(K) * beside.T @ beside, lower=True)
    answers = [linalg.solve_triangular(root, model.centreline[axis].T, lower=True) for axis in (0, 1)]
    R = np.asarray(R)
    images = [R[0, axis] * answers[0] + R[1, axis] * answers[1] for axis in (0, 1)]
    on_answers = np.hstack(images) @ np.linalg.pinv(np.hstack(answers), rcond=DEPENDENT)
    return linalg.solve_triangular(root.T, on_answers @ root.T, lower=False)
