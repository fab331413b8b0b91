"""The rigid disk (chapter, section 5.1, eq. 5) and the plane, attached by the rows that read the shaft's motion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Disk


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneAttachment:
    """A place on the shaft for unbalance or force; x, y, a, b of the shaft there are `rows @ q`."""

    name: str
    rows: NDArray[np.float64]  # (4, dof)


@dataclass(frozen=True, slots=True, kw_only=True)
class DiskAttachment:
    """A rigid disk on whatever coordinates the model has: x, y, a, b of its centre are `rows @ q`."""

    name: str
    rows: NDArray[np.float64]  # (4, dof)
    mass: float  # kg
    polar: float  # kg m^2
    transverse: float  # kg m^2, about a diameter


def attach_disk(disk: Disk, rows: NDArray[np.float64]) -> DiskAttachment:
    """Attach a nameplate disk to the node that `rows` (4, dof) read."""
    return DiskAttachment(
        name=disk.name, rows=rows, mass=disk.mass, polar=disk.polar_inertia, transverse=disk.transverse_inertia
    )


def disk_mass(disk: DiskAttachment) -> NDArray[np.float64]:
    """Return M_T + M_R of eq. (5), (dof, dof)."""
    inertia = np.array([disk.mass, disk.mass, disk.transverse, disk.transverse])
    return (disk.rows.T * inertia) @ disk.rows


def disk_gyroscopic(disk: DiskAttachment) -> NDArray[np.float64]:
    """Return G for rotation from x towards y, (dof, dof): It a'' + Omega Ip b' = 0 and It b'' - Omega Ip a' = 0."""
    half = disk.polar * np.outer(disk.rows[2], disk.rows[3])
    return half - half.T


def unbalance_direction(plane: DiskAttachment | PlaneAttachment, rotation: int) -> NDArray[np.complex128]:
    """Return the force phasor of a unit rotating force at the plane, (dof,): (1, -j) for rotation x to y.

    With Re(F e^{j theta}) this is (cos theta, sin theta); the other sense of rotation turns y's sign.
    """
    return plane.rows[0] - 1j * rotation * plane.rows[1]
