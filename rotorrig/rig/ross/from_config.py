"""From a rig's config to a rotor of ROSS: `ross_rotor(rig, nodes=...)`."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from rotorrig.rig.config import COEFFICIENTS, Bearing, OverSpeed, RigConfig, Tube
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.rotor import BearingElement, DiskElement, Material, RossRotor, ShaftElement


def ross_rotor(rig: RigConfig, *, nodes: Sequence[float]) -> RossRotor:
    """Return the rotor on a mesh of `nodes` [m], which must hold the ends of sections and every disk and bearing.

    Raises ConfigError on what ROSS cannot represent: a rigid bearing or one that resists tilt, structural damping,
    rotation from y to x.
    """
    _check(rig)
    z = np.asarray(nodes, dtype=float)

    def node(position: float) -> int:
        return int(np.argmin(np.abs(z - position)))

    return RossRotor(
        shaft=tuple(_element(rig, i, left, right) for i, (left, right) in enumerate(pairwise(z.tolist()))),
        disks=tuple(
            DiskElement(
                tag=disk.name,
                n=node(disk.position),
                mass=disk.mass,
                transverse_inertia=disk.transverse_inertia,
                polar_inertia=disk.polar_inertia,
            )
            for disk in rig.disks
        ),
        bearings=tuple(_bearing(bearing, node(bearing.position)) for bearing in rig.bearings),
        notes=tuple(_notes(rig)),
    )


def _check(rig: RigConfig) -> None:
    if rig.rotation != "x-to-y":
        raise ConfigError(f"rotation: got '{rig.rotation}', want 'x-to-y': a rotor of ROSS turns no other way")
    if rig.shaft.structural_damping:
        raise ConfigError(
            f"shaft.structural_damping: got {rig.shaft.structural_damping:g}, want 0 or rayleigh: ROSS has none"
        )
    for bearing in rig.bearings:
        if bearing.rigid:
            raise ConfigError(f"bearing '{bearing.name}': is rigid, want kxx and kyy: ROSS has no rigid support")
        if bearing.tilt_stiffness:
            raise ConfigError(
                f"bearing '{bearing.name}': has a tilt_stiffness, want none: ROSS's bearings resist no tilt"
            )


def _element(rig: RigConfig, n: int, left: float, right: float) -> ShaftElement:
    tube = _tube_at(rig, (left + right) / 2)
    return ShaftElement(
        tag=f"Shaft Element {n}",
        n=n,
        length=right - left,
        outer=(tube.diameter, tube.diameter),
        inner=(tube.inner_diameter, tube.inner_diameter),
        material=Material(tube.density, tube.youngs_modulus, tube.youngs_modulus / (2 * (1 + tube.poisson_ratio))),
        alpha=rig.shaft.rayleigh.mass,
        beta=rig.shaft.rayleigh.stiffness,
    )


def _tube_at(rig: RigConfig, position: float) -> Tube:
    return next(tube for tube in reversed(rig.shaft.tubes) if tube.start < position)


def _bearing(bearing: Bearing, n: int) -> BearingElement:
    """Put all tables on one list of speeds: straight lines between them make that exact."""
    given = {key: getattr(bearing, key) for key in COEFFICIENTS}
    frequency = sorted({omega for value in given.values() if isinstance(value, OverSpeed) for omega in value.speed})
    return BearingElement(
        tag=bearing.name,
        n=n,
        frequency=tuple(frequency),
        coefficients={key: _values(value, frequency) for key, value in given.items()},
    )


def _values(value: float | OverSpeed, frequency: Sequence[float]) -> tuple[float, ...]:
    if isinstance(value, OverSpeed):
        return tuple(np.interp(frequency, value.speed, value.value).tolist())
    return (value,) * max(1, len(frequency))


def _notes(rig: RigConfig) -> list[str]:
    """Return, in sentences, what has no place in ROSS's file."""
    left = ["[[probes]]", *(["[[planes]]"] if rig.planes else [])]
    left += [f"the unbalance of '{disk.name}'" for disk in rig.disks if disk.unbalance]
    left += [f"[{key}]" for key in ("keyphasor", "motor", "daq", "limits", "plans", "identify") if getattr(rig, key)]
    notes = [f"Left out, as ROSS keeps them elsewhere or has none: {', '.join(left)}."]
    curved = ", ".join(f"'{bearing.name}'" for bearing in rig.bearings if bearing.over_speed)
    if curved:
        notes.append(
            "Coefficients over speed are joined by straight lines in the config, by a curve in ROSS, of four speeds or "
            f"more a smoothed one: {curved}."
        )
    return notes
