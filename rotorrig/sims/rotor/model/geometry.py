"""Geometry of a rotor: where its parts stand along the shaft, how thick it is and how hubs stiffen it, to be changed.

The mesh moves with the parts. A disk, with its hub, and a bearing keep their nodes, and what is between them and what
stays is carried along in proportion (mesh.py). So a moved part stands at a node wherever it is, as if the mesh had been
made for it; the matrices are smooth in all positions, and the rows that read a part stay as they are: loads, force laws
and rigid bearings go with it. Probes stay where they are: their rows interpolate by the shape functions of the element
they look at; where that begins or ends, a row's derivative jumps with the shear in it, 3e-5 of the largest on the RK4.
Parts at one place move as one; planes, which have no mass, go with the shaft about them.

Derivatives are by a complex step, exact to rounding since all of it is rational in lengths and diameters (Squire,
Trapp, SIAM Review 40, 1998, 110).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Probe, RigConfig, Tube
from rotorrig.sims.rotor.model.beam import (
    Element,
    Properties,
    deflection_shapes,
    plane_matrices,
    properties,
    shear_share,
)
from rotorrig.sims.rotor.model.mesh import FARTHEST, Carriage, Edges, carriage

Matrix = NDArray[np.float64]

STIFFEST = 0.95  # of the shaft's flexibility that a hub may take away
WIDEST = 0.3  # relative, that the diameter may be off
STEP = 1e-30  # of a complex step: nothing is subtracted, so it cannot be too small


class Shape(NamedTuple):
    """What of a geometry may be changed; 0 is the nameplate's."""

    places: NDArray  # (place,) m, of disks and bearings
    probes: NDArray  # (probe,) m
    hubs: NDArray  # (hub,) share of the shaft's flexibility in bending that it takes away
    diameter: NDArray  # (1,) relative


class ShaftMatrices(NamedTuple):
    """The bare shaft and what reads it, as in RotorModel, or the derivatives of that."""

    M: Matrix
    G: Matrix
    K: Matrix
    weight: Matrix
    probes: Matrix
    centreline: Matrix
    z: Matrix


class OnePlane(NamedTuple):
    """The shaft in one plane, on that plane's own and inner coordinates."""

    mass: NDArray
    tilt: NDArray
    stiffness: NDArray
    weight: NDArray  # (coordinate,)
    probes: NDArray  # (probe, coordinate)
    centreline: NDArray  # (node, coordinate)
    z: NDArray  # (node,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """What the matrices of the bare shaft and the rows of the probes follow from."""

    shape: Shape
    element: Element
    z: Matrix  # (node,) m from the coupling, on the nameplate
    carriage: Carriage
    probes: tuple[str, ...]
    looks: Matrix  # (probe, 3) position [m], cosine and sine of the angle, on the nameplate
    hubs: tuple[str, ...]  # disks whose hubs have nodes at their edges
    under: Matrix  # (hub, element) 1 under the hub
    of: Properties  # of the elements, on the nameplate
    youngs_modulus: float = 1.0  # factor on the nameplate
    density: float = 1.0  # factor on the nameplate
    held: NDArray[np.intp]  # those of a plane's coordinates w, a of every node that are the rotor's own
    inner: Matrix  # (the rest, load) forces that bend the shaft between them, of which each is one more coordinate
    basis: Matrix  # (2 plane, own and inner, dof) these from the rotor's coordinates


def lay_out(
    rig: RigConfig, z: Matrix, unit: Matrix, tubes: Sequence[Tube], *, hubs: Edges, element: Element
) -> Geometry:
    """Return the geometry of a nameplate on the nodes `z`, elements being of `tubes`.

    `unit` (4 node, dof) reads all coordinates of the nodes.
    """
    middle = (z[:-1] + z[1:]) / 2
    under = [(middle > begins) & (middle < ends) for begins, ends in hubs.values()]
    carried = carriage(rig, z, hubs)
    return Geometry(
        shape=Shape(*(np.zeros(n) for n in (len(carried.range), len(rig.probes), len(hubs), 1))),
        element=element,
        z=z,
        carriage=carried,
        probes=tuple(probe.name for probe in rig.probes),
        looks=np.array([_look(probe) for probe in rig.probes]),
        hubs=tuple(hubs),
        under=np.array(under, dtype=float).reshape(len(hubs), len(middle)),
        of=properties(tubes),
        held=np.arange(2 * len(z)),
        inner=np.zeros((0, 0)),
        basis=unit.reshape(len(z), 2, 2, -1).transpose(2, 0, 1, 3).reshape(2, 2 * len(z), -1),
    )


def position_range(geometry: Geometry, part: str) -> float:
    """Return how far [m] either way the part "disk NAME", "bearing NAME" or "probe NAME" may be moved."""
    kind, number = _place(geometry, part)
    return FARTHEST if kind == "probes" else float(geometry.carriage.range[number])


def reshape(
    geometry: Geometry, *, positions: Mapping[str, float], hubs: Mapping[str, float], diameter: float
) -> Geometry:
    """Return the geometry with these differences from the nameplate, instead of any it had.

    Raises ValueError on an unknown name or a difference beyond its range.
    """
    shape = Shape(*(np.zeros_like(part) for part in geometry.shape))
    for part, value in positions.items():
        kind, number = _place(geometry, part)
        getattr(shape, kind)[number] += value
    for disk, value in hubs.items():
        _check(f"hub of '{disk}'", value, 0.0, STIFFEST, "of the shaft's flexibility")
        shape.hubs[_hub(geometry, disk)] = value
    for part in positions:
        far = position_range(geometry, part)
        kind, number = _place(geometry, part)
        _check(f"position of {part}", float(getattr(shape, kind)[number]), -far, far, "m")
    _check("diameter", diameter, -WIDEST, WIDEST, "of the nameplate's")
    shape.diameter[0] = diameter
    return replace(geometry, shape=shape)


def shaft_at(geometry: Geometry) -> ShaftMatrices:
    """Return the bare shaft of this geometry."""
    return _in_both_planes(geometry, one_plane(geometry, geometry.shape))


def differentiate_position(geometry: Geometry, part: str) -> ShaftMatrices:
    """Return the derivative by the position [m] of the part "disk NAME", "bearing NAME" or "probe NAME"."""
    return _differentiate(geometry, *_place(geometry, part))


def differentiate_hub(geometry: Geometry, disk: str) -> ShaftMatrices:
    """Return the derivative by the share of flexibility that the disk's hub takes away."""
    return _differentiate(geometry, "hubs", _hub(geometry, disk))


def differentiate_diameter(geometry: Geometry) -> ShaftMatrices:
    """Return the derivative by the relative difference of the diameter."""
    return _differentiate(geometry, "diameter", 0)


def _differentiate(geometry: Geometry, kind: str, number: int) -> ShaftMatrices:
    moved = getattr(geometry.shape, kind).astype(complex)
    moved[number] += 1j * STEP
    plane = one_plane(geometry, geometry.shape._replace(**{kind: moved}))
    return _in_both_planes(geometry, OnePlane(*(np.imag(part) / STEP for part in plane)))


def one_plane(geometry: Geometry, shape: Shape) -> OnePlane:
    """Return the shaft in one plane, in a shape that may be complex."""
    z = geometry.z + geometry.carriage.nodes @ shape.places
    of, length = _properties(geometry, shape), np.diff(z)
    elements = plane_matrices(of, length, element=geometry.element)
    mass, tilt, stiffness = (_join(A) for A in elements)
    V = bend_between(stiffness, geometry.held, geometry.inner)
    rows = _interpolate(geometry, shape, of, z, length)
    E, density = geometry.youngs_modulus, geometry.density
    return OnePlane(
        mass=density * V.T @ mass @ V,
        tilt=density * V.T @ tilt @ V,
        stiffness=E * V.T @ stiffness @ V,
        weight=density * mass[0::2].sum(axis=0) @ V,
        probes=rows @ V,
        centreline=V[0::2],
        z=z,
    )


def bend_between(stiffness: NDArray, held: NDArray[np.intp], inner: NDArray) -> NDArray:
    """Return a plane's coordinates from those that are `held` and the amounts of `inner` forces between them.

    (coordinate, held and inner): the shaft bent by a unit of one, all other held ones being zero.
    """
    size = len(stiffness)
    V = np.zeros((size, len(held) + inner.shape[1]), stiffness.dtype)
    V[held, np.arange(len(held))] = 1
    between = np.setdiff1d(np.arange(size), held)
    if len(between):
        forces = np.hstack([-stiffness[np.ix_(between, held)], inner])
        V[between] = np.linalg.solve(stiffness[np.ix_(between, between)], forces)
    return V


def _properties(geometry: Geometry, shape: Shape) -> Properties:
    """Return the properties of the elements, modulus and density as on the nameplate."""
    of, wider = geometry.of, 1 + shape.diameter[0]
    return Properties(
        bending=of.bending * wider**4 / (1 - shape.hubs @ geometry.under),
        shear=of.shear * wider**2,
        mass=of.mass * wider**2,
        tilt=of.tilt * wider**4,
    )


def _join(elements: NDArray) -> NDArray:
    """Return the matrix of a plane's coordinates from those of its elements (element, 4, 4)."""
    count = len(elements)
    whole = np.zeros((2 * count + 2, 2 * count + 2), elements.dtype)
    at = 2 * np.arange(count)[:, None] + np.arange(4)
    np.add.at(whole, (at[:, :, None], at[:, None, :]), elements)
    return whole


def _interpolate(geometry: Geometry, shape: Shape, of: Properties, z: NDArray, length: NDArray) -> NDArray:
    """Return the rows that read the deflection at the probes, (probe, coordinate of a plane)."""
    at = geometry.looks[:, 0] + shape.probes
    number = np.clip(np.searchsorted(z.real, at.real, side="right") - 1, 0, len(length) - 1)
    own = Properties(*(each[number] for each in of))
    s = (at - z[number]) / length[number]
    N = deflection_shapes(s[:, None], length[number], shear_share(own, length[number]))[..., 0]
    rows = np.zeros((len(at), 2 * len(z)), N.dtype)
    np.put_along_axis(rows, 2 * number[:, None] + np.arange(4), N, axis=1)
    return rows


def _in_both_planes(geometry: Geometry, plane: OnePlane) -> ShaftMatrices:
    """Return the shaft on the rotor's coordinates."""
    x, y = geometry.basis
    inertia, half = plane.mass + plane.tilt, 2 * x.T @ plane.tilt @ y  # a slender slice has Ip = 2 It
    _, cos, sin = geometry.looks.T[..., None]
    return ShaftMatrices(
        M=x.T @ inertia @ x + y.T @ inertia @ y,
        G=half - half.T,
        K=x.T @ plane.stiffness @ x + y.T @ plane.stiffness @ y,
        weight=np.stack([plane.weight @ x, plane.weight @ y]),
        probes=cos * (plane.probes @ x) + sin * (plane.probes @ y),
        centreline=np.stack([plane.centreline @ x, plane.centreline @ y]),
        z=plane.z,
    )


def _look(probe: Probe) -> tuple[float, float, float]:
    return probe.position, float(np.cos(probe.angle)), float(np.sin(probe.angle))


def _place(geometry: Geometry, part: str) -> tuple[str, int]:
    """Return the field of Shape and the number in it. Raises ValueError."""
    kind, _, name = part.partition(" ")
    known = {
        "disk": geometry.carriage.disks,
        "bearing": geometry.carriage.bearings,
        "probe": {probe: i for i, probe in enumerate(geometry.probes)},
    }
    if name not in known.get(kind, {}):
        wanted = [f"{kind} {name}" for kind, names in known.items() for name in names]
        raise ValueError(f"the model has no part '{part}' to be moved, want one of {wanted}")
    return "probes" if kind == "probe" else "places", known[kind][name]


def _hub(geometry: Geometry, disk: str) -> int:
    if disk not in geometry.hubs:
        raise ValueError(f"the model has no hub of a disk '{disk}', want one of {list(geometry.hubs)} (see assemble)")
    return geometry.hubs.index(disk)


def _check(what: str, value: float, low: float, high: float, unit: str) -> None:
    if not low <= value <= high:
        raise ValueError(f"{what} is off by {value:g}, want {low:g} to {high:g} {unit}")
