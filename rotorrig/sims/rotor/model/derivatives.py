"""Directions: derivatives of a model's matrices by the parameters of a fit."""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model.assembly import RotorModel, geometry_of, hysteretic, matrices, speed_stiffness
from rotorrig.sims.rotor.model.disk import disk_gyroscopic, disk_mass
from rotorrig.sims.rotor.model.geometry import (
    ShaftMatrices,
    differentiate_diameter,
    differentiate_hub,
    differentiate_position,
)

Complex = NDArray[np.complex128]
NOTHING = np.zeros((2, 2))


class Direction(NamedTuple):
    """Derivatives by one parameter of the matrices of assembly.matrices and speed_stiffness, (dof, dof) each.

    And of what the probes see of the motion, where they are moved along the shaft.
    """

    M: NDArray[np.float64]
    C: NDArray[np.float64]
    G: NDArray[np.float64]
    K: NDArray[np.float64 | np.complex128]  # of K + j D under structural damping
    H: NDArray[np.float64] | float = 0.0
    S: NDArray[np.float64] | float = 0.0
    T: NDArray[np.complex128] | float = 0.0
    P: NDArray[np.float64] | float = 0.0  # of the rows of the probes, (probe, dof)


def along_bearing(
    model: RotorModel, names: str | Collection[str], *, K: ArrayLike = NOTHING, C: ArrayLike = NOTHING
) -> Direction:
    """Return the direction that adds K [N/m] and C [N s/m], (2, 2) each, to the bearings of those names.

    By k = e^p of kxx alone: K = diag(k, 0). Raises ValueError on a name that is not an elastic bearing's.
    """
    zero = np.zeros_like(model.shaft.M)
    rows = [model.bearing(name).rows for name in ((names,) if isinstance(names, str) else names)]
    return Direction(
        M=zero,
        C=sum((r.T @ np.asarray(C, dtype=float) @ r for r in rows), zero),
        G=zero,
        K=sum((r.T @ np.asarray(K, dtype=float) @ r for r in rows), zero),
    )


def along_modulus(model: RotorModel) -> Direction:
    """Return the derivative by ln E of the shaft, its proportional and structural damping included."""
    zero, K = np.zeros_like(model.shaft.M), model.shaft.K
    return Direction(M=zero, C=model.rayleigh.stiffness * K, G=zero, K=K + 1j * hysteretic(model))


def along_density(model: RotorModel) -> Direction:
    """Return the derivative by the logarithm of the shaft's density, proportional damping included."""
    M, _, G, _ = model.shaft
    zero = np.zeros_like(M)
    return Direction(M=M, C=model.rayleigh.mass * M, G=model.rotation * G, K=zero)


def along_disk_mass(model: RotorModel) -> Direction:
    """Return the derivative by the logarithm of every disk's mass and inertias, as `scale_properties` changes them."""
    zero = np.zeros_like(model.shaft.M)
    return Direction(
        M=sum((disk_mass(disk) for disk in model.disks), zero),
        C=zero,
        G=model.rotation * sum((disk_gyroscopic(disk) for disk in model.disks), zero),
        K=zero,
    )


def along_position(model: RotorModel, part: str) -> Direction:
    """Return the derivative by the position [m] of "disk NAME", "bearing NAME" or "probe NAME", see `with_geometry`.

    By that of a probe only its row changes. Raises ValueError on an unknown name.
    """
    return _along_geometry(model, differentiate_position(geometry_of(model), part))


def along_disk_position(model: RotorModel, name: str) -> Direction:
    """Return the derivative by the position [m] of a disk. Raises as along_position."""
    return along_position(model, f"disk {name}")


def along_bearing_position(model: RotorModel, name: str) -> Direction:
    """Return the derivative by the position [m] of a bearing. Raises as along_position."""
    return along_position(model, f"bearing {name}")


def along_probe_position(model: RotorModel, name: str) -> Direction:
    """Return the derivative by the position [m] of a probe. Raises as along_position."""
    return along_position(model, f"probe {name}")


def along_diameter(model: RotorModel) -> Direction:
    """Return the derivative by the relative difference of the shaft's diameter, as `with_geometry` changes it."""
    return _along_geometry(model, differentiate_diameter(geometry_of(model)))


def along_hub(model: RotorModel, disk: str) -> Direction:
    """Return the derivative by the share of the shaft's flexibility that the disk's hub takes away.

    At none of it this is the derivative by the relative second moment of area too. Raises ValueError where the model
    has no nodes at the hub's edges.
    """
    return _along_geometry(model, differentiate_hub(geometry_of(model), disk))


def along_tilt(model: RotorModel, name: str) -> Direction:
    """Return the derivative by the tilt stiffness [N m/rad] of a bearing. Raises ValueError."""
    zero = np.zeros_like(model.shaft.M)
    rows = model.tilt(name).rows
    return Direction(M=zero, C=zero, G=zero, K=rows.T @ rows)


def probe_changes(directions: Sequence[Direction], probes: int, dof: int) -> NDArray[np.float64]:
    """Return the changes of the probes' rows, (direction, probe, dof); rows beyond those of a direction stay."""
    changes = np.zeros((len(directions), probes, dof))
    for change, direction in zip(changes, directions, strict=True):
        if np.ndim(direction.P):
            change[: len(np.asarray(direction.P))] = direction.P
    return changes


def finite_difference(before: RotorModel, after: RotorModel, step: float) -> Direction:
    """Return the direction from one model's matrices to another's of the same coordinates, per `step`."""
    a, b = matrices(before), matrices(after)
    M, C, G, K = ((y - x) / step for x, y in zip(a, b, strict=True))
    loss = (hysteretic(after) - hysteretic(before)) / step
    H, S = ((y - x) / step for x, y in zip(speed_stiffness(before), speed_stiffness(after), strict=True))
    return Direction(
        M=M,
        C=C,
        G=G,
        K=K + 1j * loss if loss.any() else K,
        H=H,
        S=S,
        T=_rotating_difference(before, after) / step,
        P=0.0 if after.probes is before.probes else (after.probes - before.probes) / step,
    )


def _along_geometry(model: RotorModel, change: ShaftMatrices) -> Direction:
    """Return the direction of a change of the bare shaft, its proportional and structural damping included."""
    return Direction(
        M=change.M,
        C=model.rayleigh.mass * change.M + model.rayleigh.stiffness * change.K,
        G=model.rotation * change.G,
        K=change.K + 1j * model.structural_damping * change.K if model.structural_damping else change.K,
        P=change.probes if change.probes.any() else 0.0,
    )


def _rotating_difference(before: RotorModel, after: RotorModel) -> NDArray[np.complex128] | float:
    """Return the difference of what turns with the shaft."""
    a, b = (0.0 if model.added.T is None else model.added.T for model in (before, after))
    return b - a
