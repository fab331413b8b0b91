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


def coefficients(bearing: Bearing) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return K [N/m] and C [N s/m] of a nameplate bearing, (2, 2) each."""
    K = np.array([[bearing.kxx, bearing.kxy], [bearing.kyx, bearing.kyy]])
    C = np.array([[bearing.cxx, bearing.cxy], [bearing.cyx, bearing.cyy]])
    return K, C


def bearing_stiffness(bearing: BearingAttachment) -> NDArray[np.float64]:
    """Return K^b of eq. (7), (dof, dof)."""
    return bearing.rows.T @ bearing.K @ bearing.rows


def bearing_damping(bearing: BearingAttachment) -> NDArray[np.float64]:
    """Return C^b of eq. (7), (dof, dof)."""
    return bearing.rows.T @ bearing.C @ bearing.rows
