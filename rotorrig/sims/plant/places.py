"""Places on a rig by its nameplate and its truth, and its sense of rotation."""

import itertools
import math

from rotorrig.rig import DataError
from rotorrig.rig.config import Bearing, Disk, RigConfig
from rotorrig.sims.plant.truth import BearingTruth, Truth

SAME_PLACE = 1e-6  # m; places nearer than this are one


def sense(rig: RigConfig) -> float:
    """Return the sign of the speed: 1 from x to y, -1 from y to x."""
    return 1.0 if rig.rotation == "x-to-y" else -1.0


def sought_bearings(rig: RigConfig) -> tuple[Bearing, ...]:
    """Return the bearings that are to be identified, else all."""
    if rig.identify is None:
        return rig.bearings
    return tuple(rig.bearing(name) for group in rig.identify.bearings for name in group)


def held_bearings(rig: RigConfig) -> tuple[Bearing, ...]:
    """Return the bearings a fit takes from the nameplate, else the first."""
    return tuple(b for b in rig.bearings if b not in sought_bearings(rig)) or rig.bearings[:1]


def true_bearing(truth: Truth, bearing: Bearing) -> BearingTruth:
    """Return what the coefficients of `bearing` really are."""
    return next(b for b in truth.bearings if b.name == bearing.name)


def disk_of_number(rig: RigConfig, number: float) -> Disk:
    """Return the disk of that number in the config, from 0. Raises DataError if there is none."""
    return rig.disks[_whole(number, len(rig.disks), f"disk of '{rig.name}'")]


def probe_of_number(rig: RigConfig, number: float) -> int:
    """Return the number of a probe in the config, from 0, as an index. Raises DataError if there is none."""
    return _whole(number, len(rig.probes), f"probe of '{rig.name}'")


def same_plane(rig: RigConfig, probe: int) -> list[int]:
    """Return the probes at the place of `probe`, itself among them, by their index in the config."""
    return [k for k, p in enumerate(rig.probes) if abs(p.position - rig.probes[probe].position) < SAME_PLACE]


def bending_spans(rig: RigConfig, truth: Truth, *cuts: float) -> list[tuple[float, float, float]]:
    """Return the shaft from the first of `cuts` [m] to the last, cut there and where its section changes.

    Each span is its start, its end [m] and its bending stiffness E I [N m^2], as it really is.
    """
    tubes = rig.shaft.tubes
    changes = [t.start for t in tubes if min(cuts) < t.start < max(cuts)]
    ends = sorted({*cuts, *changes})
    spans = []
    for start, end in itertools.pairwise(ends):
        if end - start > SAME_PLACE:
            tube = next((t for t in reversed(tubes) if t.start < (start + end) / 2), tubes[0])
            second_moment = math.pi / 64 * (tube.diameter**4 - tube.inner_diameter**4)
            spans.append((start, end, tube.youngs_modulus * truth.modulus_factor * second_moment))
    return spans


def _whole(number: float, count: int, what: str) -> int:
    if number != int(number) or not 0 <= number < count:
        raise DataError(f"number {number:g}: is no {what}, want a whole number from 0 to {count - 1}")
    return int(number)
