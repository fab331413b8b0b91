"""A model of twenty-odd coordinates that answers as the full one, also after its bearings have changed.

The basis holds the lowest modes and the static responses to a unit load at every bearing, disk, plane and probe and
to gravity (Craig, Kurdila, Fundamentals of Structural Dynamics, 2006, ch. 17). At zero frequency the reduced model is
exact whatever the bearings' stiffness and Young's modulus, because the span of (K + rows^T k rows)^-1 rows^T does not
depend on k; the modes are those of the bearings as given, and carry that to higher frequencies.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from rotorrig.sims.rotor.model.assembly import RotorModel, matrices, transform
from rotorrig.sims.rotor.model.bearing import BearingAttachment, with_coefficients

HOLDING = 1e3  # N/m: a bearing of less (0: to be identified) still holds the shaft while the basis is made
DEPENDENT = 1e-9  # singular values below this part of the largest are repeated directions


def reduce(model: RotorModel, *, modes: int = 10) -> RotorModel:
    """Return the model on `modes` undamped modes and the static responses at bearings, disks, planes and probes.

    configs/rk4.toml to 4000 rpm, 26 of 128 DOF: within 4e-7 of the peak for spring or left bearings of 1e2 to 1e7 N/m,
    Young's modulus and disk mass 5 % off. The rotor of Lalanne and Ferraris to 15 000 rpm, past its fourth critical
    speed: 2e-5 with 10 modes. A model whose geometry is to be changed: component_modes.py.
    """
    return replace(transform(model, _basis(model, modes)), geometry=None)


def _basis(model: RotorModel, modes: int) -> NDArray[np.float64]:
    """Return the basis, (dof, reduced), orthonormal with respect to the mass."""
    held = [with_coefficients(b, holding_stiffness(b), np.zeros((2, 2))) for b in model.bearings]
    system = matrices(replace(model, bearings=tuple(held)))
    rows = [part.rows for kind in (model.bearings, model.disks, model.planes) for part in kind]
    loads = np.vstack([*rows, model.probes, model.weight, model.appended])
    loads = loads[np.any(loads, axis=1)]  # a part on a rigid bearing has no row but tilt
    static = linalg.solve(system.K, loads.T, assume_a="pos")
    _, shapes = linalg.eigh(system.K, system.M, subset_by_index=[0, min(modes, model.dof) - 1])
    root = linalg.cholesky(system.M)  # upper: M = root^T root
    directions = root @ np.hstack([shapes, static])
    left, size, _ = np.linalg.svd(directions / np.linalg.norm(directions, axis=0), full_matrices=False)
    return linalg.solve_triangular(root, left[:, size > DEPENDENT * size[0]])


def holding_stiffness(bearing: BearingAttachment) -> NDArray[np.float64]:
    """Return a stiffness that holds the shaft, of the size of the bearing's at the lowest speed it is given at."""
    return np.diag(np.maximum(bearing.stiffness[0].diagonal(), HOLDING))
