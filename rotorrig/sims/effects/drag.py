"""Drag on a disk that whirls in a fluid: damping that grows with the speed of the motion.

f = -c2 |v| v: nothing at low speed, most at the peak, the reverse of dry friction. Source: Morison's drag term;
Vance, Zeidan, Murphy, Machinery Vibration and Rotordynamics (2010), ch. 2.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import disks
from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw

COEFFICIENTS = tuple(map(float, np.geomspace(1.0, 300.0, 9)))  # N s^2/m^2: a factor of 2 apart


@dataclass(frozen=True, kw_only=True)
class Drag(Effect):
    """The coefficient "c2" [N s^2/m^2] at one disk."""

    name = "drag"
    title = "drag on a disk"
    law_error = 0.1
    orders = EVERY
    linear_in = "c2"
    disk: str

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return its force."""
        return (ForceLaw(rows=model.disk(self.disk).rows[:2], force=quadratic, constants=np.array([theta["c2"]])),)

    def words(self, theta: Theta) -> str:
        """Say how strong it is."""
        return f"a fluid drags on {self.disk} with {theta['c2']:.3g} N per (m/s)^2"


@njit(cache=True)
def quadratic(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return -c2 |v| v."""
    factor = -constants[0] * np.hypot(vx, vy)
    return factor * vx, factor * vy


def effects(rig: RigConfig) -> tuple[Drag, ...]:
    """Return one for every disk."""
    unknown = (
        Parameter(name="c2", unit="N s^2/m^2", low=0.0, high=500.0, size=20.0, starts=COEFFICIENTS, of_rig=True),
    )
    return tuple(Drag(where=where, disk=disk.name, parameters=unknown) for where, disk in disks(rig).items())
