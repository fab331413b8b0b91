"""Unbalance in a plane where none is sought: a set screw, a coupling hub, a balance ring.

Linear in its amount. Along the shaft the place is an unknown as well: a grid search finds it roughly, then it is
fitted with the amount. Source: Bently, Hatch, Fundamentals of Rotating Machinery Diagnostics (2002), ch. 16.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import Effect, Parameter, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import free_places, unbalance_sought
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.rotor.model import Load, RotorModel

AMOUNT = pair("unbalance", "kg m", most=30e-6, size=5e-6, of_rig=True)


@dataclass(frozen=True, kw_only=True)
class UnbalancePlane(Effect):
    """The phasor "unbalance" [kg m] at a disk or plane of the model, or on the shaft, "shift" [m] past `position`."""

    name = "unbalance_plane"
    title = "unbalance in another plane"
    plane: str = ""  # of the model; "": none
    position: float = 0.0  # m from the coupling, where there is none
    length: float = 0.0  # m, of the shaft
    along: Mapping[str, float] = field(default_factory=dict, compare=False, repr=False)  # every place of the grid

    def relocate(self, theta: Theta) -> tuple["UnbalancePlane", Theta]:
        """Return it from the place of the grid that is nearest to where it is."""
        if self.plane:
            return self, theta
        z = self._place(theta)
        where = min(self.along, key=lambda name: abs(self.along[name] - z))
        moved = _on_shaft(where, self.along, self.length, self.parameters[:2]) if where != self.where else self
        return moved, {**theta, "shift": z - moved.position}

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return its centrifugal force."""
        rows = model.plane(self.plane).rows[:2] if self.plane else position_rows(model, self._place(theta))
        pattern = phasor(theta, "unbalance") * forward(rows, model.rotation)
        return (Load(pattern=pattern, law="unbalance"),)

    def words(self, theta: Theta) -> str:
        """Say how much it is and where."""
        size, angle = polar(theta, "unbalance")
        where = self.where if self.plane else f"{1e3 * self._place(theta):.0f} mm from the coupling"
        return f"an unbalance of {1e6 * size:.2g} g mm sits {where}, {angle:.0f} deg from the keyphasor mark"

    def _place(self, theta: Theta) -> float:
        """Return where it is on the shaft [m]; a fit that goes past an end comes back from it."""
        past_end = (self.position + theta.get("shift", 0.0)) % (2 * self.length)
        return min(past_end, 2 * self.length - past_end)


def effects(rig: RigConfig) -> tuple[UnbalancePlane, ...]:
    """Return the disks and planes whose unbalance is not sought, then places along the free shaft."""
    sought = unbalance_sought(rig)
    named = tuple(
        UnbalancePlane(where=f"at {name}", plane=name, parameters=AMOUNT)
        for name in (*(plane.name for plane in rig.planes), *(disk.name for disk in rig.disks))
        if name not in sought
    )
    places = free_places(rig)
    return named + tuple(_on_shaft(where, places, rig.shaft.length) for where in places)


def _on_shaft(
    where: str, places: Mapping[str, float], length: float, amount: tuple[Parameter, ...] = AMOUNT
) -> UnbalancePlane:
    """Return the one that begins at a place of the grid; a fit may take it anywhere along the shaft."""
    z = places[where]
    shift = Parameter(name="shift", unit="m", low=-z, high=length - z, size=0.005)
    return UnbalancePlane(where=where, position=z, length=length, along=places, parameters=(*amount, shift))
