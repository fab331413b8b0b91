"""A pedestal or table that gives way under a bearing, more in one direction than across, with a resonance of its own.

A mass on springs to the ground in series with the bearing; probes stand on the ground. Far from its resonance it is
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
ACROSS = tuple(float(share) for share in np.geomspace(0.02, 1.0, 16))  # looked at from where a fit ended
LOOKED_AT = tuple(HZ * float(f) for f in np.geomspace(9.0, 65.0, 32))  # rad/s: 7 % apart, a resonance's width


@dataclass(frozen=True, kw_only=True)
class Pedestal(Effect):
    """The "lightness" 1 / m [1/kg], natural frequency "omega" [rad/s] alone and "damping ratio" of the pedestal.

    An infinite mass has an infinite spring at the same frequency: nothing gives way. "compliance across" is that at
    right angles to `axis`, as a share of the one along it; without, the pedestal does not give way there.
    """

    name = "pedestal"
    title = "pedestal with a resonance"
    orders = EVERY
    linear_in = "lightness"
    scales_base = False
    bearings: tuple[str, ...]
    axis: int  # 0 along x, 1 along y

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with the pedestal's coordinate, and these bearings between it and the shaft."""
        if not theta["lightness"]:
            return model
        mass, omega, zeta = 1 / theta["lightness"], theta["omega"], theta["damping ratio"]
        model = self._on_spring(model, mass=mass, omega=omega, zeta=zeta, axis=self.axis)
        if not (compliance := theta.get("compliance across", 0.0)):
            return model
        omega /= math.sqrt(compliance)
        return self._on_spring(model, mass=mass, omega=omega, zeta=zeta, axis=1 - self.axis)

    def _on_spring(self, model: RotorModel, *, mass: float, omega: float, zeta: float, axis: int) -> RotorModel:
        """Return the model with the pedestal's coordinate along an axis, of that mass [kg] and frequency [rad/s]."""
        larger = with_coordinates(model, 1)
        pedestal = larger.appended[-1]
        relative = np.outer(np.eye(2)[axis], pedestal)
        bearings = (replace(b, rows=b.rows - relative) if b.name in self.bearings else b for b in larger.bearings)
        own = mass * np.outer(pedestal, pedestal)
        C = 2 * zeta * omega * own
        return with_added(replace(larger, bearings=tuple(bearings)), Added(M=own, C=C, K=omega**2 * own))

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
        Parameter(name="lightness", unit="1/kg", low=0.0, high=1.0, size=0.1, starts=(0.02, 0.12), of_rig=True),
        Parameter(
            name="omega",
            unit="rad/s",
            low=8 * HZ,
            high=70 * HZ,
            size=2 * HZ,
            at_zero=30 * HZ,
            starts=LOOKED_AT,
            of_rig=True,
        ),
        Parameter(name="damping ratio", unit="", low=0.005, high=0.15, size=0.02, at_zero=0.03, starts=(0.03,)),
        Parameter(name="compliance across", unit="", low=0.0, high=1.0, size=0.1, starts=(0.1, 0.3)),
    )
    return tuple(
        Pedestal(
            where=f"{where + ', ' if where else ''}{'xy'[axis]}",
            bearings=names,
            axis=axis,
            parameters=unknown,
            initial_guesses=tuple({"compliance across": share} for share in ACROSS),
        )
        for where, names in bearing_groups(rig).items()
        for axis in (0, 1)
    )
