"""The rotor rubs on something fixed: a seal, a casing, the rub screw of a kit.

Beyond a radial gap, centred on where the shaft rests, a stiff wall pushes back and drags against the sliding surface:
f = -k (1 - gap / |r|) (r + j mu r). The drag drives backward whirl, until that rolls on the wall: the speed that the
surface has by rotation is taken as at half the drive's highest. Source: Muszynska, Rotordynamics (2005), ch. 5; Jiang,
Ulbrich, J. Vib. Acoust. 127 (2005) 594.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import BESIDE_DISK, reference_speed, span, tube_at
from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw

GAPS = tuple(map(float, np.geomspace(50e-6, 800e-6, 14)))  # m: a quarter apart
WALLS = (4e3, 2e4, 1e5, 1e6)  # N/m, from a ring in soft rubber over a rub screw on a spring to a casing
ROLLING = 0.05  # m/s: slower than this the surfaces hardly slide
MID_SPAN = "mid-span"  # the name of its plane


@dataclass(frozen=True, kw_only=True)
class Rub(Effect):
    """The radial "gap" [m], the wall's "stiffness" [N/m] and its "friction" coefficient; no stiffness is no wall."""

    name = "rub"
    title = "rub"
    law_error = 0.1
    orders = EVERY
    place: str  # disk or plane
    surface_speed: float  # m/s, of the turning shaft

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return the wall's force."""
        turning = model.rotation * self.surface_speed
        constants = np.array([theta["gap"], theta["stiffness"], theta["friction"], turning])
        return (ForceLaw(rows=model.plane(self.place).rows[:2], force=wall, constants=constants),)

    def words(self, theta: Theta) -> str:
        """Say where, how far away, how hard and how rough the wall is."""
        return (
            f"the rotor rubs at {self.place} beyond {1e6 * theta['gap']:.0f} um, on a wall of "
            f"{theta['stiffness'] / 1e6:.2g} N/um with a friction coefficient of {theta['friction']:.2f}"
        )


@njit(cache=True)
def wall(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return the push back and the drag of constants gap, stiffness, friction and surface speed."""
    gap, stiffness = constants[0], constants[1]
    r = np.hypot(x, y)
    if r <= gap or r == 0.0:
        return 0.0, 0.0
    k = -stiffness * (1.0 - gap / r)
    sliding = constants[3] + (x * vy - y * vx) / r
    friction = constants[2] * sliding / np.hypot(sliding, ROLLING)
    return k * (x - friction * y), k * (y + friction * x)


def effects(rig: RigConfig) -> tuple[Rub, ...]:
    """Return one at every disk, and one halfway between the bearings if no disk is there."""
    unknown = (
        Parameter(
            name="gap",
            unit="m",
            low=50e-6,
            high=1e-3,
            size=50e-6,
            at_zero=300e-6,
            starts=GAPS,
            of_rig=True,
        ),
        Parameter(name="stiffness", unit="N/m", low=0.0, high=1e7, size=1e5, starts=WALLS, of_rig=True),
        Parameter(name="friction", unit="", low=0.0, high=0.4, size=0.1, starts=(0.05,)),
    )
    middle = sum(span(rig)) / 2
    places = {disk.name: disk.position for disk in rig.disks}
    if all(abs(z - middle) >= BESIDE_DISK for z in places.values()):
        places[MID_SPAN] = middle
    return tuple(
        Rub(
            where=f"at {place}",
            place=place,
            surface_speed=reference_speed(rig) * tube_at(rig, z).diameter / 2,
            places={MID_SPAN: z} if place == MID_SPAN else {},
            parameters=unknown,
        )
        for place, z in places.items()
    )
