"""From a nameplate to the equations of motion (chapter, section 5.4, eq. 8): `assemble(rig)` is a `RotorModel`.

"The chapter" in this package: Kim, Yang et al., A Hybrid Evolutionary Algorithm and its Application to Parameter
Identification of Rolling Elements Bearings, sections 5.1 to 5.5.

A model is the shaft's matrices plus attachments given by the rows that read their motion, so that a reduced model
(reduction.py) is the same type and a bearing, a disk's mass or Young's modulus is changed without a new assembly.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig.config import Rayleigh, RigConfig, Tube
from rotorrig.sims.rotor.model.beam import NODE_DOF, X_PLANE, Y_PLANE, Element, plane_matrices, properties
from rotorrig.sims.rotor.model.bearing import (
    BearingAttachment,
    TiltAttachment,
    attach_bearing,
    bearing_damping,
    bearing_stiffness,
    tilt_stiffness,
    with_coefficients,
)
from rotorrig.sims.rotor.model.disk import DiskAttachment, PlaneAttachment, attach_disk, disk_gyroscopic, disk_mass
from rotorrig.sims.rotor.model.geometry import Geometry, lay_out, reshape, shaft_at
from rotorrig.sims.rotor.model.mesh import hub_edges, mesh, node_at


class _Named(Protocol):
    @property
    def name(self) -> str: ...


T = TypeVar("T", bound=_Named)
NOWHERE: Mapping[str, float] = MappingProxyType({})


class Matrices(NamedTuple):
    """M q'' + (C + Omega G) q' + K q = F, each (dof, dof); G already has the sense of rotation."""

    M: NDArray[np.float64]
    C: NDArray[np.float64]
    G: NDArray[np.float64]
    K: NDArray[np.float64]


class Added(NamedTuple):
    """Matrices added to the nameplate's, (dof, dof) each, in fixed axes; None: zero.

    In a motion Re(q e^{j n theta}) it adds K + Omega H + Omega^2 S - n^2 Omega^2 M + j n Omega (C + Omega G) to the
    dynamic stiffness. The sense of rotation is already in G and H. A complex K has a loss factor: its imaginary part is
    that of n > 0, and changes sign with n. A stiffness Re(T e^{2 j theta}), T symmetric, turns with the shaft
    (rotating_stiffness.py): it is felt at 1X alone.
    """

    M: NDArray[np.float64] | None = None
    C: NDArray[np.float64] | None = None
    G: NDArray[np.float64] | None = None
    K: NDArray[np.float64 | np.complex128] | None = None
    H: NDArray[np.float64] | None = None
    S: NDArray[np.float64] | None = None
    T: NDArray[np.complex128] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RotorModel:
    """A linear rotor: shaft, disks, bearings and probes, on physical or reduced coordinates q (dof,)."""

    shaft: Matrices  # of the bare shaft, C zero; K is proportional to Young's modulus, G is for rotation x to y
    rayleigh: Rayleigh  # the shaft's proportional damping
    structural_damping: float  # the shaft's loss factor
    disks: tuple[DiskAttachment, ...]
    planes: tuple[PlaneAttachment, ...]
    bearings: tuple[BearingAttachment, ...]  # the elastic ones; x = y = 0 at a rigid one is in the coordinates
    rigid: tuple[str, ...]  # names of the rigid bearings
    tilts: tuple[TiltAttachment, ...]  # of every bearing, a rigid one too
    probes: NDArray[np.float64]  # (probe, dof): displacement towards each probe, angles applied
    rotation: int  # +1 x to y, -1 y to x
    z: NDArray[np.float64]  # (node,) m from the coupling, for drawing
    centreline: NDArray[np.float64]  # (2, node, dof): x and y of every node
    weight: NDArray[np.float64]  # (2, dof) kg: the shaft's load per unit of gravity along x and along y
    appended: NDArray[np.float64]  # (coordinate, dof): reads the coordinates of with_coordinates
    added: Added
    geometry: Geometry | None  # what all of the bare shaft follows from; None: on a basis for the nameplate's alone

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.shaft.M)

    def disk(self, name: str) -> DiskAttachment:
        """Return the disk of that name. Raises ValueError."""
        return _find_named(self.disks, name, "disk")

    def plane(self, name: str) -> DiskAttachment | PlaneAttachment:
        """Return the disk or plane of that name. Raises ValueError."""
        places: tuple[DiskAttachment | PlaneAttachment, ...] = (*self.disks, *self.planes)
        return _find_named(places, name, "disk or plane" if self.planes else "disk")

    def bearing(self, name: str) -> BearingAttachment:
        """Return the elastic bearing of that name. Raises ValueError."""
        if name in self.rigid:
            raise ValueError(f"bearing '{name}' is rigid and has no coefficients, want an elastic one")
        return _find_named(self.bearings, name, "bearing")

    def tilt(self, name: str) -> TiltAttachment:
        """Return how the bearing of that name resists tilt. Raises ValueError."""
        return _find_named(self.tilts, name, "bearing")


def assemble(
    rig: RigConfig, *, element: Element = "timoshenko", max_element: float = 0.02, hubs: bool = False
) -> RotorModel:
    """Return the finite-element model of a nameplate: nodes at both ends, at every step of the shaft and at every part.

    Spans between them are divided evenly into elements no longer than `max_element` [m]. Where a bearing is rigid, the
    coordinates x and y of its node are left out, which holds it exactly. With `hubs` there are nodes at the edges of
    every disk's hub too, for `with_geometry` to stiffen the shaft there. Raises ValueError.
    """
    if element not in ("timoshenko", "lumped"):
        raise ValueError(f"element is {element!r}, want 'timoshenko' or 'lumped'")
    if not max_element > 0:
        raise ValueError(f"max_element is {max_element:g} m, want a length above zero")
    edges = hub_edges(rig) if hubs else {}
    z = mesh(rig, max_element, edges)
    tubes = [rig.shaft.tube_at(place) for place in (z[:-1] + z[1:]) / 2]
    free = _free(rig, z)
    whole = _shaft_matrices(tubes, z, element)
    unit = np.eye(NODE_DOF * len(z))[:, free]
    x, y = unit[0::NODE_DOF], unit[1::NODE_DOF]

    def rows(position: float, first: int, count: int) -> NDArray[np.float64]:
        start = NODE_DOF * node_at(z, position) + first
        return unit[start : start + count]

    return RotorModel(
        shaft=Matrices(*(A[np.ix_(free, free)] for A in whole)),
        rayleigh=rig.shaft.rayleigh,
        structural_damping=rig.shaft.structural_damping,
        disks=tuple(attach_disk(d, rows(d.position, 0, NODE_DOF)) for d in rig.disks),
        planes=tuple(PlaneAttachment(name=p.name, rows=rows(p.position, 0, NODE_DOF)) for p in rig.planes),
        bearings=tuple(attach_bearing(b, rows(b.position, 0, 2)) for b in rig.bearings if not b.rigid),
        rigid=tuple(b.name for b in rig.bearings if b.rigid),
        tilts=tuple(
            TiltAttachment(name=b.name, rows=rows(b.position, 2, 2), stiffness=b.tilt_stiffness) for b in rig.bearings
        ),
        probes=np.array([[math.cos(p.angle), math.sin(p.angle)] @ rows(p.position, 0, 2) for p in rig.probes]),
        rotation=1 if rig.rotation == "x-to-y" else -1,
        z=z,
        centreline=np.stack([x, y]),
        weight=np.stack([whole.M[axis::NODE_DOF, free].sum(0) for axis in (0, 1)]),
        appended=np.zeros((0, len(free))),
        added=Added(),
        geometry=lay_out(rig, z, unit, tubes, hubs=edges, element=element),
    )


def matrices(model: RotorModel, omega: float | None = None) -> Matrices:
    """Return the assembled M, C, G, K of eq. (8); at shaft speed Omega, Z = K - Omega^2 M + j Omega (C + Omega G).

    Structural damping is not among them, see `hysteretic`, nor what `speed_stiffness` tells. Bearings whose
    coefficients depend on speed want `omega` [rad/s]: raises ConfigError without.
    """
    M, C, G, K = model.shaft
    C = C + model.rayleigh.mass * M + model.rayleigh.stiffness * K
    for disk in model.disks:
        M = M + disk_mass(disk)
        G = G + disk_gyroscopic(disk)
    for bearing in model.bearings:
        C = C + bearing_damping(bearing, omega)
        K = K + bearing_stiffness(bearing, omega)
    for tilt in model.tilts:
        if tilt.stiffness:
            K = K + tilt_stiffness(tilt)
    more = model.added
    stiffness = None if more.K is None else more.K.real
    return Matrices(_plus(M, more.M), _plus(C, more.C), _plus(model.rotation * G, more.G), _plus(K, stiffness))


def speed_stiffness(model: RotorModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return H and S, (dof, dof) N s/m and N s^2/m: at the shaft speed Omega the stiffness has Omega H + Omega^2 S."""
    zero = np.zeros_like(model.shaft.K)
    return _plus(zero, model.added.H), _plus(zero, model.added.S)


def hysteretic(model: RotorModel) -> NDArray[np.float64]:
    """Return the structural damping D, (dof, dof) N/m: K becomes K + j D in a motion Re(q e^{j w t}), w > 0.

    The loss per cycle does not depend on frequency. It does not turn with the shaft, so it never drives a whirl. For
    w < 0 the sign turns; without meaning for a motion that is not harmonic.
    """
    D = model.structural_damping * model.shaft.K
    return D if model.added.K is None else D + model.added.K.imag


def with_added(model: RotorModel, added: Added) -> RotorModel:
    """Return the model with these matrices beside those it has. Raises ValueError on another shape."""
    want = (model.dof, model.dof)
    for name, A in zip(Added._fields, added, strict=True):
        if A is not None and np.shape(A) != want:
            raise ValueError(f"added {name} has shape {np.shape(A)}, want (dof, dof) = {want}")
    sums = [B if A is None else _plus(A, B) for A, B in zip(model.added, added, strict=True)]
    return replace(model, added=Added._make(sums))


def with_coordinates(model: RotorModel, count: int) -> RotorModel:
    """Return the model with `count` new coordinates after its own, on which nothing acts yet.

    A pedestal's x and y, say: `added` brings its mass, damping and stiffness, and its bearing then reads the shaft's
    motion less the pedestal's. Until it has a mass the model has no equations of motion. `model.appended` reads these.
    """
    dof = model.dof + count
    larger = transform(model, np.eye(model.dof, dof))
    return replace(larger, appended=np.vstack([larger.appended, np.eye(dof)[model.dof :]]))


def transform(model: RotorModel, V: NDArray[np.float64]) -> RotorModel:
    """Return the model on the coordinates p of q = V p, V (dof, new)."""

    def project(A: NDArray) -> NDArray:
        return V.T @ A @ V

    return replace(
        model,
        shaft=Matrices(*(project(A) for A in model.shaft)),
        disks=tuple(replace(d, rows=d.rows @ V) for d in model.disks),
        planes=tuple(replace(p, rows=p.rows @ V) for p in model.planes),
        bearings=tuple(replace(b, rows=b.rows @ V) for b in model.bearings),
        tilts=tuple(replace(t, rows=t.rows @ V) for t in model.tilts),
        probes=model.probes @ V,
        centreline=model.centreline @ V,
        weight=model.weight @ V,
        added=Added(*(None if A is None else project(A) for A in model.added)),
        appended=model.appended @ V,
        geometry=None if model.geometry is None else replace(model.geometry, basis=model.geometry.basis @ V),
    )


def with_bearing(model: RotorModel, names: str | Collection[str], K: ArrayLike, C: ArrayLike) -> RotorModel:
    """Return the model with the bearings of those names given constant K [N/m] and C [N s/m], (2, 2) each.

    Raises ValueError on an unknown or rigid bearing, another shape, NaN, or a negative direct coefficient.
    """
    names = (names,) if isinstance(names, str) else names
    for name in names:
        model.bearing(name)
    return replace(model, bearings=tuple(with_coefficients(b, K, C) if b.name in names else b for b in model.bearings))


def geometry_of(model: RotorModel) -> Geometry:
    """Return the geometry of a model. Raises ValueError on one that was reduced without it."""
    if model.geometry is None:
        raise ValueError("the model is reduced for its nameplate's geometry alone, want one of `condense_spans`")
    return model.geometry


def with_tilt(model: RotorModel, stiffness: Mapping[str, float]) -> RotorModel:
    """Return the model with these bearings resisting tilt by so much [N m/rad]. Raises ValueError."""
    for name, value in stiffness.items():
        model.tilt(name)
        if not 0 <= value < math.inf:
            raise ValueError(f"tilt stiffness of bearing '{name}' is {value:g} N m/rad, want zero or more")
    return replace(model, tilts=tuple(replace(t, stiffness=stiffness.get(t.name, t.stiffness)) for t in model.tilts))


def with_geometry(
    model: RotorModel,
    *,
    positions: Mapping[str, float] = NOWHERE,
    hubs: Mapping[str, float] = NOWHERE,
    diameter: float = 0.0,
) -> RotorModel:
    """Return the model with its geometry off the nameplate by so much, instead of by what it was: geometry.py.

    `positions` is "disk NAME", "bearing NAME" or "probe NAME" -> m further from the coupling. `hubs` is disk -> share
    of the shaft's flexibility in bending that its hub takes away: 0.5 is twice the second moment of area. `diameter`
    is relative, of all of the shaft, bores too. Raises ValueError on an unknown name, a difference out of range, or a
    model that `reduce` made.
    """
    geometry = reshape(geometry_of(model), positions=positions, hubs=hubs, diameter=diameter)
    shaft = shaft_at(geometry)
    return replace(
        model,
        shaft=Matrices(shaft.M, np.zeros_like(shaft.M), shaft.G, shaft.K),
        probes=shaft.probes,
        weight=shaft.weight,
        centreline=shaft.centreline,
        z=shaft.z,
        geometry=geometry,
    )


def scale_properties(
    model: RotorModel, *, youngs_modulus: float = 1.0, density: float = 1.0, disk_mass: float = 1.0
) -> RotorModel:
    """Return the model with the shaft's Young's modulus and density and every disk's mass multiplied by those factors.

    A disk's inertias follow its mass, as for a disk of the same shape and another density; the shaft's do too.
    """
    disks = tuple(
        replace(d, mass=d.mass * disk_mass, polar=d.polar * disk_mass, transverse=d.transverse * disk_mass)
        for d in model.disks
    )
    M, C, G, K = model.shaft
    shaft = Matrices(M * density, C, G * density, K * youngs_modulus)
    geometry = model.geometry
    if geometry is not None:
        geometry = replace(
            geometry,
            youngs_modulus=geometry.youngs_modulus * youngs_modulus,
            density=geometry.density * density,
        )
    return replace(model, shaft=shaft, disks=disks, weight=model.weight * density, geometry=geometry)


def _free(rig: RigConfig, z: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the coordinates that no rigid bearing holds: the columns of a basis of the constraint's null space."""
    held = [NODE_DOF * node_at(z, b.position) + axis for b in rig.bearings if b.rigid for axis in (0, 1)]
    return np.setdiff1d(np.arange(NODE_DOF * len(z)), held)


def _shaft_matrices(tubes: Sequence[Tube], z: NDArray[np.float64], element: Element) -> Matrices:
    dof = NODE_DOF * len(z)
    M, C, G, K = (np.zeros((dof, dof)) for _ in range(4))
    for node, (mass, tilt, stiffness) in enumerate(
        zip(*plane_matrices(properties(tubes), np.diff(z), element=element), strict=True)
    ):
        x, y = NODE_DOF * node + X_PLANE, NODE_DOF * node + Y_PLANE
        for dofs in (x, y):
            M[np.ix_(dofs, dofs)] += mass + tilt  # M_T + M_R of eq. (6)
            K[np.ix_(dofs, dofs)] += stiffness
        G[np.ix_(x, y)] += 2 * tilt  # a slender slice has Ip = 2 It
        G[np.ix_(y, x)] -= 2 * tilt
    return Matrices(M, C, G, K)


def _plus(A: NDArray, B: NDArray | None) -> NDArray:
    return A if B is None else A + B


def _find_named(parts: tuple[T, ...], name: str, kind: str) -> T:
    for part in parts:
        if part.name == name:
            return part
    raise ValueError(f"the model has no {kind} '{name}', want one of {[part.name for part in parts]}")
