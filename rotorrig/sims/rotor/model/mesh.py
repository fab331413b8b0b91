"""Nodes of a rotor along its shaft, and how they are carried along when parts of it move."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import SHORTEST, Disk, RigConfig

Edges = Mapping[str, tuple[float, float]]  # disk -> where its hub begins and ends [m]

FARTHEST = 10e-3  # m that a part may be moved
FOLLOWS = 2 * FARTHEST  # m: a step or end of the shaft nearer to a part moves with it
CLOSER = 0.4  # of the distance between two parts that each may be moved towards the other


class Carriage(NamedTuple):
    """Places that may move along the shaft, several parts at some, and the nodes that go with them."""

    disks: dict[str, int]  # name -> place
    bearings: dict[str, int]  # name -> place
    nodes: NDArray[np.float64]  # (node, place) of a place's motion
    range: NDArray[np.float64]  # (place,) m either way


def mesh(rig: RigConfig, max_element: float, hubs: Edges) -> NDArray[np.float64]:
    """Return the nodes [m]: at both ends, steps and parts, and between them no farther apart than `max_element`."""
    parts = [part.position for kind in (rig.bearings, rig.disks, rig.planes, rig.probes) for part in kind]
    edges = [edge for hub in hubs.values() for edge in hub]
    fixed = sorted({0.0, rig.shaft.length, *parts, *edges, *(tube.start for tube in rig.shaft.tubes)})
    kept = [place for before, place in pairwise([-1.0, *fixed]) if place - before > SHORTEST]
    return np.array([*_divide(kept, max_element), kept[-1]])


def node_at(z: NDArray[np.float64], position: float) -> int:
    """Return the number of the node nearest to a position [m]."""
    return int(np.argmin(np.abs(z - position)))


def hub_edges(rig: RigConfig) -> Edges:
    """Return where the hub of every disk begins and ends, within the shaft; at most halfway to the next part."""
    held = [part.position for kind in (rig.disks, rig.bearings) for part in kind]
    return {disk.name: _hub(rig, disk, held) for disk in rig.disks}


def carriage(rig: RigConfig, z: NDArray[np.float64], hubs: Edges) -> Carriage:
    """Return how the nodes `z` are carried along by disks, hubs and all, and bearings.

    Between two parts in proportion; the ends and steps of the shaft stay, unless nearer to a part than `FOLLOWS`.
    """
    positions = sorted({z[node_at(z, part.position)] for kind in (rig.disks, rig.bearings) for part in kind})
    place = {position: i for i, position in enumerate(positions)}
    disks, bearings = (
        {part.name: place[z[node_at(z, part.position)]] for part in kind} for kind in (rig.disks, rig.bearings)
    )
    rest = (0.0, rig.shaft.length, *(tube.start for tube in rig.shaft.tubes))
    stays = {at for at in rest if np.abs(np.subtract(positions, at)).min() > FOLLOWS}
    moved = place | {z[node_at(z, edge)]: disks[name] for name, hub in hubs.items() for edge in hub} | place
    points = sorted({*moved, *stays})
    of = [moved.get(point, -1) for point in points]
    carried = [np.interp(z, points, np.equal(of, i).astype(float)) for i in range(len(place))]
    gaps = [(b - a, i, j) for (a, i), (b, j) in pairwise(zip(points, of, strict=True)) if i != j]
    free = [min([FARTHEST, *(CLOSER * gap for gap, *both in gaps if i in both)]) for i in range(len(place))]
    return Carriage(disks, bearings, np.stack(carried, axis=-1), np.array(free))


def _divide(places: list[float], max_element: float) -> Iterator[float]:
    for left, right in pairwise(places):
        count = math.ceil((right - left) / max_element * (1 - 1e-9))  # 100 mm is five times 20 mm, rounding or not
        yield from np.linspace(left, right, count, endpoint=False)


def _hub(rig: RigConfig, disk: Disk, held: list[float]) -> tuple[float, float]:
    half, at = rig.hub_width(disk.name) / 2, disk.position
    before = [(at - other) / 2 for other in held if other < at - SHORTEST]
    behind = [(other - at) / 2 for other in held if other > at + SHORTEST]
    return at - min([half, at, *before]), at + min([half, rig.shaft.length - at, *behind])
