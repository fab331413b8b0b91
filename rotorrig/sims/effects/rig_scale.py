"""Scale of a rig: how stiff it is, how far it moves and how fast it turns, beside the RK4 that sizes are stated for.

Two rigs that differ in these alone answer alike, so what is typical of one is typical of the other when it is
multiplied by their ratios to the powers that its unit asks for (Buckingham, Phys. Rev. 4 (1914) 345). What belongs to
the probes, to the layout or to two surfaces, as runout, a place or the height of asperities, has no part in it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Self

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.places import bearing_groups, group_stiffness

POWERS: Mapping[str, tuple[int, int, int]] = MappingProxyType(  # of the ratios of stiffness, motion and speed
    {
        "N/m": (1, 0, 0),
        "m": (0, 1, 0),
        "N": (1, 1, 0),
        "N/m^3": (1, -2, 0),
        "N s^2/m^2": (1, -1, -2),
        "kg m": (1, 1, -2),
        "1/kg": (-1, 0, 2),
        "rad/s": (0, 0, 1),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RigScale:
    """Stiffness [N/m] of the bearings sought, largest 1X motion [m, 0-peak] at a probe, and the speed [rad/s] of it."""

    stiffness: float
    motion: float
    speed: float

    @classmethod
    def of(cls, rig: RigConfig, *, motion: float, speed: float) -> Self:
        """Return the scale of a rig that moved so far at that speed."""
        stiff = [group_stiffness(rig, names) for names in bearing_groups(rig).values()]
        return cls(stiffness=float(np.mean(stiff)), motion=motion, speed=speed)

    def ratio(self, unit: str) -> float:
        """Return what a size of that unit, typical of the RK4, is to be multiplied by. Raises KeyError if unknown."""
        stiffness, motion, speed = POWERS[unit]
        return (
            (self.stiffness / RK4.stiffness) ** stiffness
            * (self.motion / RK4.motion) ** motion
            * (self.speed / RK4.speed) ** speed
        )


RK4 = RigScale(stiffness=34e3, motion=360e-6, speed=238.0)  # configs/rk4.toml, swept through its critical speed
