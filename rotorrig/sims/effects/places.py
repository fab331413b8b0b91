"""Places on a rig where an effect could act: its bearings sought, disks, probe planes and stretches of free shaft."""

import math
from collections.abc import Sized
from itertools import pairwise

import numpy as np

from rotorrig.rig.config import RPM, Bearing, Disk, OverSpeed, Probe, RigConfig, Tube

USUAL = 2000.0 / RPM  # rad/s, where no drive tells the highest speed
SAME = 1e-6  # m: parts nearer than this stand in one plane
STEP, MOST_STEPS = 0.04, 14  # m between places of a grid along the shaft: finer, neighbours cannot be told apart
BESIDE_DISK, BESIDE_BEARING = 0.02, 0.015  # m that a grid keeps away


def bearing_groups(rig: RigConfig) -> dict[str, tuple[str, ...]]:
    """Return the groups of bearings sought by what to call the place: "" if there is one, else "bearing left A".

    Without [identify] every elastic bearing is one.
    """
    elastic = tuple((b.name,) for b in rig.bearings if not b.rigid)
    groups = rig.identify.bearings if rig.identify else elastic
    return {place_label(f"bearing {'+'.join(group)}", groups): group for group in groups}


def other_bearings(rig: RigConfig) -> tuple[Bearing, ...]:
    """Return the elastic bearings that are not sought."""
    sought = {name for group in bearing_groups(rig).values() for name in group}
    return tuple(b for b in rig.bearings if not b.rigid and b.name not in sought)


def bearing_words(names: tuple[str, ...]) -> str:
    """Return what to call a group in a sentence.

    >>> bearing_words(("left A", "left B"))
    'bearings left A and left B'
    """
    return f"bearing{'s' if len(names) > 1 else ''} {' and '.join(names)}"


def stiffness(bearing: Bearing) -> float:
    """Return the mean of kxx and kyy [N/m] of an elastic bearing, over its speeds where it has a table."""
    direct = (bearing.kxx, bearing.kyy)
    return float(np.mean([np.mean(k.value) if isinstance(k, OverSpeed) else k for k in direct if k is not None]))


def group_stiffness(rig: RigConfig, names: tuple[str, ...]) -> float:
    """Return the mean stiffness [N/m] of a group of bearings."""
    return float(np.mean([stiffness(rig.bearing(name)) for name in names]))


def unbalance_sought(rig: RigConfig) -> tuple[str, ...]:
    """Return the disks and planes whose unbalance is sought; without [identify] the first disk."""
    return rig.identify.unbalance if rig.identify else (rig.disks[0].name,)


def disks(rig: RigConfig) -> dict[str, Disk]:
    """Return the disks by what to call the place: "" if there is one, else its name."""
    return {place_label(disk.name, rig.disks): disk for disk in rig.disks}


def probe_planes(rig: RigConfig) -> dict[str, tuple[Probe, ...]]:
    """Return the probes of every plane, by its name: "plane 1" is the nearest to the coupling."""
    planes: list[list[Probe]] = []
    for probe in sorted(rig.probes, key=lambda p: p.position):
        if planes and probe.position - planes[-1][0].position < SAME:
            planes[-1].append(probe)
        else:
            planes.append([probe])
    return {f"plane {i}": tuple(plane) for i, plane in enumerate(planes, start=1)}


def free_places(rig: RigConfig) -> dict[str, float]:
    """Return the places of a grid along the shaft [m] by name, not beside a disk, bearing or balance plane."""
    count = int(np.clip(round(rig.shaft.length / STEP), 1, MOST_STEPS))
    kept_off = [(disk.position, BESIDE_DISK) for disk in rig.disks]
    kept_off += [(plane.position, BESIDE_DISK) for plane in rig.planes]
    kept_off += [(bearing.position, BESIDE_BEARING) for bearing in rig.bearings]
    return {
        f"at {1e3 * z:.0f} mm": float(z)
        for z in np.linspace(0.0, rig.shaft.length, count + 1)
        if all(abs(z - place) > off for place, off in kept_off)
    }


def span(rig: RigConfig) -> tuple[float, float]:
    """Return the ends [m] of the longest stretch between neighbouring bearings."""
    places = sorted(b.position for b in rig.bearings)
    left, right = max(pairwise(places), key=lambda ends: ends[1] - ends[0])
    return left, right


def tube_at(rig: RigConfig, z: float) -> Tube:
    """Return the stretch of shaft at z [m]."""
    return next((tube for tube in rig.shaft.tubes if z < tube.end), rig.shaft.tubes[-1])


def reference_speed(rig: RigConfig) -> float:
    """Return a speed [rad/s] in the middle of what the rig does: half the drive's highest."""
    return rig.motor.max_speed / 2 if rig.motor else USUAL


def place_label(name: str, all_of_them: Sized) -> str:
    """Return the name of a place, "" where there is no other."""
    return name if len(all_of_them) > 1 else ""


def sense(rig: RigConfig) -> int:
    """Return +1 for rotation x to y, -1 for y to x."""
    return 1 if rig.rotation == "x-to-y" else -1


def bending_stiffness(tube: Tube) -> float:
    """Return E I of a stretch of shaft, N m^2."""
    return tube.youngs_modulus * math.pi / 64 * (tube.diameter**4 - tube.inner_diameter**4)
