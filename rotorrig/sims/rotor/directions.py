"""Derivatives of a model's matrices by what a fit changes in it, and of the steady response along them."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.assembly import RotorModel, hysteretic
from rotorrig.sims.rotor.disk import disk_gyroscopic, disk_mass
from rotorrig.sims.rotor.harmonic import columns, dynamic_stiffness

Complex = NDArray[np.complex128]
NOTHING = np.zeros((2, 2))


class Direction(NamedTuple):
    """Derivatives by one parameter of the matrices of assembly.matrices, (dof, dof) each."""

    M: NDArray[np.float64]
    C: NDArray[np.float64]
    G: NDArray[np.float64]
    K: NDArray[np.float64 | np.complex128]  # of K + j H under structural damping


class Derivatives(NamedTuple):
    """The response to 1 kg m at each place, and what a unit of each direction adds."""

    z: Complex  # (row, probe, place) m per kg m
    by: Complex  # (direction, row, probe, place)


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
    """Return the derivative by the logarithm of every disk's mass and inertias, as assembly.scaled changes them."""
    zero = np.zeros_like(model.shaft.M)
    return Direction(
        M=sum((disk_mass(disk) for disk in model.disks), zero),
        C=zero,
        G=model.rotation * sum((disk_gyroscopic(disk) for disk in model.disks), zero),
        K=zero,
    )


def steady_derivatives(
    model: RotorModel, omega: ArrayLike, *, unbalance: Sequence[str], directions: Sequence[Direction]
) -> Derivatives:
    """Return the steady response to 1 kg m at each place at the speeds `omega` [rad/s], and its derivatives.

    dz = -P Z^-1 dZ Z^-1 F. Raises as harmonic.columns.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    q = columns(replace(model, probes=np.eye(model.dof)), omega, unbalance=unbalance)  # (speed, dof, place)
    transposed = dynamic_stiffness(model, omega).swapaxes(1, 2)
    left = np.linalg.solve(transposed, np.broadcast_to(model.probes.T, (len(omega), *model.probes.T.shape)))
    O = omega[:, None, None]  # noqa: E741
    by = [-left.swapaxes(1, 2) @ ((dK - O**2 * dM + 1j * O * (dC + O * dG)) @ q) for dM, dC, dG, dK in directions]
    return Derivatives(model.probes @ q, np.array(by).reshape(len(directions), *(model.probes @ q).shape))
