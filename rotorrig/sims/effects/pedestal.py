"""A pedestal or table that gives way under a bearing, in one direction, with a resonance of its own.

A mass on a spring to the ground in series with the bearing; probes stand on the ground. Far from its resonance it is
but another stiffness of the bearing. Source: Lees, Friswell, The evaluation of rotor imbalance in flexibly mounted
machines, J. Sound Vib. 208 (1997) 671-683.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bearing_groups, bearing_words
from rotorrig.sims.rotor.model import Added, RotorModel, with_added, with_coordinates

HZ = 2 * math.pi  # rad/s
LOOKED_AT = tuple(HZ * float(f) for f in np.geomspace(9.0, 65.0, 24))  # rad/s: 9 % apart, about a resonance's width


@dataclass(frozen=True, kw_only=True)
class Pedestal(Effect):
    """The "lightness" 1 / m [1/kg], natural frequency "omega" [rad/s] alone and "damping ratio" of the pedestal.

    An infinite mass has an infinite spring at the same frequency: nothing gives way.
    """

    name = "pedestal"
    title = "pedestal with a resonance"
    orders = EVERY
    bearings: tuple[str, ...]
    axis: int  # 0 along x, 1 along y

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with the pedestal's coordinate, and these bearings between it and the shaft."""
        if not theta["lightness"]:
            return model
        larger = with_coordinates(model, 1)
        pedestal = larger.appended[-1]
        relative = np.outer(np.eye(2)[self.axis], pedestal)
        bearings = (replace(b, rows=b.rows - relative) if b.name in self.bearings else b for b in larger.bearings)
        own = np.outer(pedestal, pedestal) / theta["lightness"]
        omega, zeta = theta["omega"], theta["damping ratio"]
        return with_added(
            replace(larger, bearings=tuple(bearings)), Added(M=own, C=2 * zeta * omega * own, K=omega**2 * own)
        )

    def words(self, theta: Theta) -> str:
        """Say how heavy it is and where it resonates."""
        mass = 1 / theta["lightness"] if theta["lightness"] else math.inf
        return (
            f"the pedestal of {bearing_words(self.bearings)} gives way along {'xy'[self.axis]}: {mass:.1f} kg with "
            f"its resonance at {theta['omega'] / HZ:.1f} Hz, damping ratio {theta['damping ratio']:.3f}"
        )


def effects(rig: RigConfig) -> tuple[Pedestal, ...]:
    """Return one along x and one along y for every group of bearings sought."""
    unknown = (
        Parameter(name="lightness", unit="1/kg", low=0.0, high=1.0, size=0.1, starts=(0.1,)),
        Parameter(
            name="omega",
            unit="rad/s",
            low=8 * HZ,
            high=70 * HZ,
            size=2 * HZ,
            at_zero=30 * HZ,
            starts=LOOKED_AT,
        ),
        Parameter(name="damping ratio", unit="", low=0.005, high=0.15, size=0.02, at_zero=0.03, starts=(0.03,)),
    )
    return tuple(
        Pedestal(where=f"{where + ', ' if where else ''}{'xy'[axis]}", bearings=names, axis=axis, parameters=unknown)
        for where, names in bearing_groups(rig).items()
        for axis in (0, 1)
    )
