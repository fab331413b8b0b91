"""The balance quality grade of what is left, ISO 21940-11: G = e omega, e = residual unbalance over the rotor's mass.

The grades are for rotors that turn well below their first critical speed; above it the residual of single planes says
little, and the vibration itself is what to judge (ISO 21940-12).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig

GRADES = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)  # mm/s, table 1 of ISO 21940-11


@dataclass(frozen=True, slots=True, kw_only=True)
class Grade:
    """A grade, and what it was reckoned from."""

    unbalance: float  # kg m, sum of the residual amounts on all planes
    mass: float  # kg of the rotor, shaft and disks of the config
    top_speed: float  # rad/s

    @property
    def product(self) -> float:
        """E omega in mm/s."""
        return 1e3 * self.unbalance / self.mass * self.top_speed

    @property
    def grade(self) -> float:
        """The grade it meets, mm/s: the next of the standard's; infinite beyond the last."""
        return next((g for g in GRADES if self.product <= g), math.inf)


def rotor_mass(rig: RigConfig) -> float:
    """Return the mass of shaft and disks as the config states them [kg]."""
    shaft = sum(
        tube.density * tube.length * math.pi / 4 * (tube.diameter**2 - tube.inner_diameter**2)
        for tube in rig.shaft.tubes
    )
    return float(shaft + sum(disk.mass for disk in rig.disks))


def grade_of(residual: NDArray[np.float64], *, mass: float, top_speed: float) -> Grade:
    """Return the grade of residual amounts per plane [kg m].

    >>> grade_of(np.array([10e-6]), mass=1.0, top_speed=300.0).grade  # 10 um times 300 rad/s: 3 mm/s
    6.3
    """
    return Grade(unbalance=float(np.sum(residual)), mass=mass, top_speed=top_speed)
