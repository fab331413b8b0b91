"""Probe planes: two probes at one place along the shaft resolve its motion into x and y, and into whirl."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig

Complex = NDArray[np.complex128]

PARALLEL = 0.1  # |sin| of the angle between two probes below which they see one axis, not an orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class Plane:
    """Two probes at one position, and the matrix from their readings to x and y."""

    position: float  # m
    probes: tuple[str, str]
    to_xy: NDArray[np.float64]  # (2, 2): (x, y) = to_xy @ (first reading, second reading)

    @property
    def name(self) -> str:
        """Name for a reader: "1x, 1y at 250.5 mm"."""
        return f"{', '.join(self.probes)} at {self.position * 1e3:g} mm"


def planes(rig: RigConfig) -> tuple[Plane, ...]:
    """Return the probe planes of a rig from the coupling outwards; probes without a partner make none."""
    planes = []
    for position in sorted({probe.position for probe in rig.probes}):
        here = [probe for probe in rig.probes if probe.position == position]
        pairs = [(a, b) for i, a in enumerate(here) for b in here[i + 1 :]]
        # the pair nearest to a right angle resolves the orbit best
        a, b = max(pairs, key=lambda pair: abs(np.sin(pair[1].angle - pair[0].angle)), default=(here[0], here[0]))
        if abs(np.sin(b.angle - a.angle)) > PARALLEL:
            rows = np.array([[np.cos(a.angle), np.sin(a.angle)], [np.cos(b.angle), np.sin(b.angle)]])
            planes.append(Plane(position=position, probes=(a.name, b.name), to_xy=np.linalg.inv(rows)))
    return tuple(planes)


def measured_planes(rig: RigConfig, probes: Sequence[str]) -> Iterator[tuple[Plane, list[int]]]:
    """Yield the planes with both probes among `probes`, and their indices there."""
    for plane in planes(rig):
        if set(plane.probes) <= set(probes):
            yield plane, [probes.index(name) for name in plane.probes]


def whirl(plane: Plane, z: Complex, *, rotation: str) -> tuple[Complex, Complex]:
    """Return the forward and backward vectors (...) of vectors z (..., 2) of the plane's probes, in its unit.

    `rotation` is "x-to-y" or "y-to-x", as in the config. A circular orbit of radius r that turns with the rotor is
    (r, 0), one against it (0, r), a straight line of amplitude r (r/2, r/2). For rotation from x to y the orbit is
    x + jy = f e^{j theta} + b* e^{-j theta}: +1X and -1X of a full spectrum.
    """
    x, y = np.moveaxis(z @ plane.to_xy.T, -1, 0)
    turn = 1j if rotation == "x-to-y" else -1j
    return (x + turn * y) / 2, (x - turn * y) / 2
