"""The linear bearing (chapter, section 5.3, eq. 7), attached to the shaft by the rows that read its motion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.description import Bearing


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingAttachment:
    """Eight coefficients between ground and the journal, whose x and y are `rows @ q`."""

    name: str
    rows: NDArray[np.float64]  # (2, dof)
    K: NDArray[np.float64]  # (2, 2) N/m
    C: NDArray[np.float64]  # (2, 2) N s/m


def attached_bearing(bearing: Bearing, rows: NDArray[np.float64]) -> BearingAttachment:
    """Return a nameplate bearing on the journal that `rows` (2, dof) read."""
    K = np.array([[bearing.kxx, bearing.kxy], [bearing.kyx, bearing.kyy]])
    C = np.array([[bearing.cxx, bearing.cxy], [bearing.cyx, bearing.cyy]])
    return BearingAttachment(name=bearing.name, rows=rows, K=K, C=C)


def bearing_stiffness(bearing: BearingAttachment) -> NDArray[np.float64]:
    """Return K^b of eq. (7), (dof, dof)."""
    return bearing.rows.T @ bearing.K @ bearing.rows


def bearing_damping(bearing: BearingAttachment) -> NDArray[np.float64]:
    """Return C^b of eq. (7), (dof, dof)."""
    return bearing.rows.T @ bearing.C @ bearing.rows
