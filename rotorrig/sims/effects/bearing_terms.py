"""Stiffness at a group of bearings, as matrices (dof, dof) of the model they are in."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model import RotorModel


def on_bearings(model: RotorModel, names: Iterable[str], k: ArrayLike) -> NDArray[np.float64]:
    """Return k [N/m], (2, 2) between x and y, at every one of those bearings."""
    rows = [model.bearing(name).rows for name in names]
    return sum((r.T @ np.asarray(k, dtype=float) @ r for r in rows), np.zeros((model.dof, model.dof)))


def own_stiffness(model: RotorModel, names: Iterable[str], omega: float = 0.0) -> NDArray[np.float64]:
    """Return the stiffness that those bearings have at the shaft speed `omega` [rad/s]."""
    return sum((on_bearings(model, [name], model.bearing(name).at(omega)[0]) for name in names), np.zeros(()))
