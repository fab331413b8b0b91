"""Unbalance in a plane where none is sought: a set screw, a coupling hub, a balance ring.

Linear in its amount; the place is found by trying one after the other. Source: Bently, Hatch, Fundamentals of Rotating
Machinery Diagnostics (2002), ch. 16.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import free_places, unbalance_sought
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.loads import Load


@dataclass(frozen=True, kw_only=True)
class UnbalancePlane(Effect):
    """The phasor "unbalance" [kg m] at a disk or plane of the model, or anywhere along the shaft."""

    name = "unbalance_plane"
    title = "unbalance in another plane"
    linear = True
    plane: str = ""  # of the model; "": none
    position: float = 0.0  # m from the coupling, where there is none

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return its centrifugal force."""
        pattern = phasor(theta, "unbalance") * forward(self._rows(model), model.rotation)
        return (Load(pattern=pattern, law="unbalance"),)

    def words(self, theta: Theta) -> str:
        """Say how much it is and where."""
        size, angle = polar(theta, "unbalance")
        return f"an unbalance of {1e6 * size:.1f} g mm sits {self.where}, {angle:.0f} deg from the keyphasor mark"

    def _rows(self, model: RotorModel) -> NDArray[np.float64]:
        return model.plane(self.plane).rows[:2] if self.plane else position_rows(model, self.position)


def effects(rig: RigConfig) -> tuple[UnbalancePlane, ...]:
    """Return the disks and planes whose unbalance is not sought, then places along the free shaft."""
    unknown = pair("unbalance", "kg m", most=30e-6, size=5e-6)
    sought = unbalance_sought(rig)
    named = tuple(
        UnbalancePlane(where=f"at {name}", plane=name, parameters=unknown)
        for name in (*(plane.name for plane in rig.planes), *(disk.name for disk in rig.disks))
        if name not in sought
    )
    between = tuple(
        UnbalancePlane(where=where, position=z, parameters=unknown) for where, z in free_places(rig).items()
    )
    return named + between
