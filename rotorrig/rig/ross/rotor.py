"""A rotor as ROSS sees it: elements between numbered nodes, SI units. The common form of reading.py and writing.py.

ROSS (rotordynamics, Apache-2.0, version 2.3) turns its rotor from x towards y as this program does, and its bearing
coefficients have the same signs.
"""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

VERSION = "2.3.0"
ROUNDING = 12  # decimals of a node's position [m]: sums of lengths carry noise of 1e-16 m


class Material(NamedTuple):
    """Material of a shaft element."""

    density: float  # kg/m^3
    youngs_modulus: float  # Pa
    shear_modulus: float  # Pa

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio of an isotropic material."""
        return self.youngs_modulus / (2 * self.shear_modulus) - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftElement:
    """A Timoshenko beam element from node `n` to the next; a pair of diameters is left and right."""

    tag: str
    n: int
    length: float  # m
    outer: tuple[float, float]  # m
    inner: tuple[float, float]  # m
    material: Material
    alpha: float = 0.0  # 1/s, C = alpha M + beta K
    beta: float = 0.0  # s

    @property
    def tapered(self) -> bool:
        """True if a diameter changes along the element."""
        return self.outer[0] != self.outer[1] or self.inner[0] != self.inner[1]

    @property
    def area(self) -> float:
        """Cross-section in the middle [m^2]."""
        outer, inner = sum(self.outer) / 2, sum(self.inner) / 2
        return math.pi / 4 * (outer**2 - inner**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area in the middle [m^4]."""
        outer, inner = sum(self.outer) / 2, sum(self.inner) / 2
        return math.pi / 64 * (outer**4 - inner**4)

    @property
    def bending_stiffness(self) -> float:
        """E I in the middle [N m^2]."""
        return self.material.youngs_modulus * self.second_moment


@dataclass(frozen=True, slots=True, kw_only=True)
class DiskElement:
    """A rigid disk."""

    tag: str
    n: int
    mass: float  # kg
    transverse_inertia: float  # kg m^2, ROSS's Id
    polar_inertia: float  # kg m^2, ROSS's Ip


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingElement:
    """A bearing or seal to ground: every coefficient has one value, or one for each shaft speed."""

    tag: str
    n: int
    kind: str = "BearingElement"  # ROSS's class
    frequency: tuple[float, ...] = ()  # rad/s; empty: constant
    coefficients: Mapping[str, tuple[float, ...]]  # by COEFFICIENTS, N/m and N s/m


@dataclass(frozen=True, slots=True, kw_only=True)
class RossRotor:
    """A rotor as ROSS sees it; `notes` say in sentences what did not come along."""

    shaft: tuple[ShaftElement, ...]  # from left to right, n = 0, 1, 2..
    disks: tuple[DiskElement, ...]
    bearings: tuple[BearingElement, ...]
    version: str = VERSION
    notes: tuple[str, ...] = ()

    @property
    def nodes(self) -> tuple[float, ...]:
        """Position of every node [m]."""
        return tuple(round(z, ROUNDING) for z in itertools.accumulate((e.length for e in self.shaft), initial=0.0))
