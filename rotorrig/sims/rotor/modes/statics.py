"""Mass of the shaft, and static loads on the bearings."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig, Shaft
from rotorrig.sims.rotor.model import area, assemble, matrices
from rotorrig.sims.rotor.modes.modes import static_solution, weight


def shaft_mass(shaft: Shaft) -> float:
    """Return the mass of a shaft [kg], its sections together."""
    return sum(tube.density * area(tube) * tube.length for tube in shaft.tubes)


def bearing_loads(rig: RigConfig) -> NDArray[np.float64]:
    """Return the force of the rotor at rest on each of its bearings, (bearing, 2) N along x and y.

    Rigid ones too: they are left out of the model's stiffness here, and the forces that hold x = y = 0 are Lagrange's
    multipliers. Raises ValueError if the bearings do not hold the shaft.
    """
    freed = [b.model_copy(update={"rigid": False, "kxx": 0.0, "kyy": 0.0}) if b.rigid else b for b in rig.bearings]
    model = assemble(rig.model_copy(update={"bearings": tuple(freed)}))
    K = matrices(model, 0.0).K
    rows = np.vstack([np.zeros((0, model.dof)), *(b.rows for b in model.bearings if rig.bearing(b.name).rigid)])
    scale = np.abs(K).max()  # so that the pins' equations weigh as much as the others
    saddle = np.block([[K, scale * rows.T], [scale * rows, np.zeros((len(rows), len(rows)))]])
    solution = static_solution(model, saddle, np.append(weight(model, rig.gravity), np.zeros(len(rows))))
    q, pinned = solution[: model.dof], iter(scale * solution[model.dof :].reshape(-1, 2))
    return np.array([next(pinned) if rig.bearing(b.name).rigid else b.at(0.0)[0] @ b.rows @ q for b in model.bearings])
