"""Rigs whose nameplate is wrong: parts sit a little elsewhere, and in a deviant one dimension is far from what it says.

Every rig has the small deviations of sims/plant/deviations.py; nobody asks for them to be named, but who names one with
the right size is right. A deviant has one that is four to ten times the standard deviation of its kind there: a
position off by 3 to 8 mm, a diameter by 0.8 to 2 %, a hub that stiffens the shaft as if it were 20 to 30 % thicker
(12 mm on 10 mm was found on a rig), a bearing that resists tilt by 80 to 200 N m/rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.deviations import draw_geometry
from rotorrig.sims.plant.places import same_plane, sought_bearings
from rotorrig.sims.plant.truth import Geometry

POSITION = (3e-3, 8e-3)  # m, either way
DIAMETER = (0.008, 0.02)  # relative, either way
HUB = (0.2, 0.3)  # of the diameter, more
TILT = (80.0, 200.0)  # N m/rad
DEVIANTS = ("bearing_position", "disk_position", "probe_position", "diameter", "hub", "tilt")


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """A dimension that is not the nameplate's: true value less the stated one, SI; of diameter and hub relative."""

    kind: str  # of `DEVIANTS`
    part: str  # name of a bearing, a disk, or the first probe of a plane; "" of the shaft
    value: float
    asked: bool  # it is the one that makes a deviant


def put_together(rig: RigConfig, deviant: str, *, seed: int) -> tuple[Geometry, tuple[Deviation, ...]]:
    """Return how the rig of a seed was put together and all its deviations; `deviant` is one of `DEVIANTS` or "".

    Raises ValueError for an unknown one.
    """
    geometry = draw_geometry(rig, seed)
    if not deviant:
        return geometry, _list_deviations(rig, geometry, "", "")
    if deviant not in DEVIANTS:
        raise ValueError(f"deviant '{deviant}': want one of {', '.join(DEVIANTS)}")
    rng = np.random.default_rng([seed, DEVIANTS.index(deviant)])
    departed, part = _depart(rig, geometry, deviant, rng)
    return departed, _list_deviations(rig, departed, deviant, part)


def _depart(rig: RigConfig, geometry: Geometry, kind: str, rng: np.random.Generator) -> tuple[Geometry, str]:
    """Return the geometry with one dimension far off, and the part whose it is."""
    sign = float(rng.choice([-1.0, 1.0]))
    position = sign * float(rng.uniform(*POSITION))
    match kind:
        case "bearing_position":
            part = str(rng.choice([bearing.name for bearing in sought_bearings(rig)]))
            at = [i for i, bearing in enumerate(rig.bearings) if bearing.name == part]
            return replace(geometry, bearing_shifts=_put(geometry.bearing_shifts, at, position)), part
        case "disk_position":
            i = int(rng.integers(len(rig.disks)))
            return replace(geometry, disk_shifts=_put(geometry.disk_shifts, [i], position)), rig.disks[i].name
        case "probe_position":
            at = same_plane(rig, int(rng.integers(len(rig.probes))))
            return replace(geometry, probe_shifts=_put(geometry.probe_shifts, at, position)), rig.probes[at[0]].name
        case "diameter":
            return replace(geometry, diameter_factor=1.0 + sign * float(rng.uniform(*DIAMETER))), ""
        case "hub":
            i, factor = int(rng.integers(len(rig.disks))), 1.0 + float(rng.uniform(*HUB))
            return replace(geometry, hub_factors=_put(geometry.hub_factors, [i], factor)), rig.disks[i].name
    i, stiffness = int(rng.integers(len(rig.bearings))), float(rng.uniform(*TILT))
    return replace(geometry, tilt_stiffnesses=_put(geometry.tilt_stiffnesses, [i], stiffness)), rig.bearings[i].name


def _put(values: Sequence[float], at: Sequence[int], value: float) -> tuple[float, ...]:
    return tuple(value if i in at else other for i, other in enumerate(values))


def _list_deviations(rig: RigConfig, geometry: Geometry, kind: str, part: str) -> tuple[Deviation, ...]:
    """Return every deviation; that of `kind` and `part` is asked for."""
    disks, bearings = ([each.name for each in parts] for parts in (rig.disks, rig.bearings))
    planes = {rig.probes[same_plane(rig, i)[0]].name: off for i, off in enumerate(geometry.probe_shifts)}
    found = [
        *(("bearing_position", name, off) for name, off in zip(bearings, geometry.bearing_shifts, strict=True)),
        *(("disk_position", name, off) for name, off in zip(disks, geometry.disk_shifts, strict=True)),
        *(("probe_position", name, off) for name, off in planes.items()),
        ("diameter", "", geometry.diameter_factor - 1.0),
        *(("hub", name, factor - 1.0) for name, factor in zip(disks, geometry.hub_factors, strict=True)),
        *(("tilt", name, k) for name, k in zip(bearings, geometry.tilt_stiffnesses, strict=True)),
    ]
    return tuple(Deviation(kind=k, part=p, value=v, asked=(k, p) == (kind, part)) for k, p, v in found)
