"""From a nameplate to the equations of motion (chapter, section 5.4, eq. 8): `assemble(rig)` is a `RotorModel`.

"The chapter" in this package: Kim, Yang et al., A Hybrid Evolutionary Algorithm and its Application to Parameter
Identification of Rolling Elements Bearings, sections 5.1 to 5.5.

A model is the shaft's matrices plus attachments given by the rows that read their motion, so that a reduced model
(reduction.py) is the same type and a bearing, a disk's mass or Young's modulus is changed without a new assembly.
"""

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.rotor.beam import NODE_DOF, Element, shaft_element
from rotorrig.sims.rotor.bearing import BearingAttachment, attached_bearing, bearing_damping, bearing_stiffness
from rotorrig.sims.rotor.disk import DiskAttachment, attached_disk, disk_gyroscopic, disk_mass

T = TypeVar("T", DiskAttachment, BearingAttachment)
MERGE = 1e-6  # m: parts nearer than this share a node


class Matrices(NamedTuple):
    """M q'' + (C + Omega G) q' + K q = F, each (dof, dof); G already has the sense of rotation."""

    M: NDArray[np.float64]
    C: NDArray[np.float64]
    G: NDArray[np.float64]
    K: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class RotorModel:
    """A linear rotor: shaft, disks, bearings and probes, on physical or reduced coordinates q (dof,)."""

    shaft: Matrices  # of the bare shaft; K is proportional to Young's modulus, G is for rotation x to y
    disks: tuple[DiskAttachment, ...]
    bearings: tuple[BearingAttachment, ...]
    probes: NDArray[np.float64]  # (probe, dof): displacement towards each probe, angles applied
    probe_names: tuple[str, ...]
    rotation: int  # +1 x to y, -1 y to x
    z: NDArray[np.float64]  # (node,) m from the coupling, for drawing
    centreline: NDArray[np.float64]  # (2, node, dof): x and y of every node
    weight: NDArray[np.float64]  # (2, dof) kg: the shaft's load per unit of gravity along x and along y

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.shaft.M)

    def disk(self, name: str) -> DiskAttachment:
        """Return the disk of that name. Raises ValueError."""
        return _named(self.disks, name, "disk")

    def bearing(self, name: str) -> BearingAttachment:
        """Return the bearing of that name. Raises ValueError."""
        return _named(self.bearings, name, "bearing")


def assemble(rig: RigConfig, *, element: Element = "timoshenko", max_element: float = 0.02) -> RotorModel:
    """Return the finite-element model of a nameplate: nodes at both ends and at every bearing, disk and probe.

    Spans between them are divided evenly into elements no longer than `max_element` [m]. Raises ValueError.
    """
    if element not in ("timoshenko", "lumped"):
        raise ValueError(f"element is {element!r}, want 'timoshenko' or 'lumped'")
    if not max_element > 0:
        raise ValueError(f"max_element is {max_element:g} m, want a length above zero")
    z = _mesh(rig, max_element)
    shaft = _shaft_matrices(rig, z, element)
    unit = np.eye(NODE_DOF * len(z))
    x, y = unit[0::NODE_DOF], unit[1::NODE_DOF]

    def rows(position: float, count: int) -> NDArray[np.float64]:
        first = NODE_DOF * int(np.argmin(np.abs(z - position)))
        return unit[first : first + count]

    return RotorModel(
        shaft=shaft,
        disks=tuple(attached_disk(d, rows(d.position, NODE_DOF)) for d in rig.disks),
        bearings=tuple(attached_bearing(b, rows(b.position, 2)) for b in rig.bearings),
        probes=np.array([[math.cos(p.angle), math.sin(p.angle)] @ rows(p.position, 2) for p in rig.probes]),
        probe_names=tuple(p.name for p in rig.probes),
        rotation=1 if rig.rotation == "x-to-y" else -1,
        z=z,
        centreline=np.stack([x, y]),
        weight=np.stack([x.sum(0), y.sum(0)]) @ shaft.M,
    )


def matrices(model: RotorModel) -> Matrices:
    """Return the assembled M, C, G, K of eq. (8); at shaft speed Omega, Z = K - Omega^2 M + j Omega (C + Omega G)."""
    M, C, G, K = model.shaft
    for disk in model.disks:
        M = M + disk_mass(disk)
        G = G + disk_gyroscopic(disk)
    for bearing in model.bearings:
        C = C + bearing_damping(bearing)
        K = K + bearing_stiffness(bearing)
    return Matrices(M, C, model.rotation * G, K)


def with_bearing(model: RotorModel, names: str | Collection[str], K: ArrayLike, C: ArrayLike) -> RotorModel:
    """Return the model with the bearings of those names given K [N/m] and C [N s/m], (2, 2) each. Raises ValueError."""
    names = (names,) if isinstance(names, str) else names
    K, C = np.asarray(K, dtype=float), np.asarray(C, dtype=float)
    for label, matrix in (("K", K), ("C", C)):
        if matrix.shape != (2, 2):
            raise ValueError(f"{label} has shape {matrix.shape}, want (2, 2)")
    for name in names:
        model.bearing(name)
    return replace(model, bearings=tuple(replace(b, K=K, C=C) if b.name in names else b for b in model.bearings))


def scaled(model: RotorModel, *, youngs_modulus: float = 1.0, disk_mass: float = 1.0) -> RotorModel:
    """Return the model with Young's modulus, and every disk's mass and inertias, multiplied by those factors.

    Inertias follow the mass, as for a disk of the same shape and another density.
    """
    disks = tuple(
        replace(d, mass=d.mass * disk_mass, polar=d.polar * disk_mass, transverse=d.transverse * disk_mass)
        for d in model.disks
    )
    return replace(model, shaft=model.shaft._replace(K=model.shaft.K * youngs_modulus), disks=disks)


def _mesh(rig: RigConfig, max_element: float) -> NDArray[np.float64]:
    bearings, disks, probes = ([part.position for part in parts] for parts in (rig.bearings, rig.disks, rig.probes))
    fixed = sorted({0.0, rig.shaft.length, *bearings, *disks, *probes})
    kept = [place for before, place in pairwise([-1.0, *fixed]) if place - before > MERGE]
    return np.array([*_divided(kept, max_element), kept[-1]])


def _divided(places: list[float], max_element: float) -> Iterator[float]:
    for left, right in pairwise(places):
        count = math.ceil((right - left) / max_element * (1 - 1e-9))  # 100 mm is five times 20 mm, rounding or not
        yield from np.linspace(left, right, count, endpoint=False)


def _shaft_matrices(rig: RigConfig, z: NDArray[np.float64], element: Element) -> Matrices:
    dof = NODE_DOF * len(z)
    M, C, G, K = (np.zeros((dof, dof)) for _ in range(4))
    for node, length in enumerate(np.diff(z)):
        place = slice(NODE_DOF * node, NODE_DOF * (node + 2))
        piece = shaft_element(rig.shaft, float(length), element=element)
        M[place, place] += piece.M
        G[place, place] += piece.G
        K[place, place] += piece.K
    return Matrices(M, C, G, K)  # the bare shaft has no damping of its own


def _named(parts: tuple[T, ...], name: str, kind: str) -> T:
    for part in parts:
        if part.name == name:
            return part
    raise ValueError(f"the model has no {kind} '{name}', want one of {[part.name for part in parts]}")
