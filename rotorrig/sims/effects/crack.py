"""A transverse crack that opens and closes once per turn as the shaft's own weight bends it.

While it is open the shaft gives way across it, so every turn it kinks in step: a local bend at the crack at 1X, 2X and
3X, of constant size while the sag is. A crack that opens along a cosine, with a soft axis across it, kinks along and
across the sag in the ratios of `DIRECTIONS`; the size of each order is left free. Source: Mayes, Davies, J. Vib.
Acoust. 106 (1984) 139-145; Bachschmid, Pennacchi, Tanzi, Cracked Rotors (2010), ch. 3.
"""

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor
from rotorrig.sims.effects.places import bending_stiffness, free_places, span, tube_at
from rotorrig.sims.effects.shaft_motion import at_rest, curvature_rows
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.loads import Load

#: order -> kink along the sag and across it, in the sense of rotation, as phasors of (1 + cos) / 2 (cos^2, cos sin)
DIRECTIONS = MappingProxyType({1: (1.0, -1j / 3), 2: (1.0, -1j), 3: (1.0, -1j)})


@dataclass(frozen=True, kw_only=True)
class Crack(Effect):
    """The phasors "kink 1X", "kink 2X", "kink 3X" [rad]: by how much the shaft bends at the crack, along its sag."""

    name = "crack"
    title = "breathing crack"
    orders = (1, 2, 3)
    linear = True
    position: float  # m from the coupling
    bending_stiffness: float  # N m^2 there
    gravity: str

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the pair of moments on either side of it, for each order."""
        bend = self.bending_stiffness * curvature_rows(model, self.position)
        along = bend @ at_rest(model, self.gravity)
        along = along / np.hypot(*along)
        across = model.rotation * np.array([-along[1], along[0]])
        return tuple(
            Load(pattern=phasor(theta, f"kink {n}X") * (down * along + side * across) @ bend, law="constant", order=n)
            for n, (down, side) in DIRECTIONS.items()
        )

    def words(self, theta: Theta) -> str:
        """Say where it is and how far it kinks."""
        once, twice, thrice = (1e6 * abs(phasor(theta, f"kink {n}X")) for n in self.orders)
        return (
            f"a crack {self.where} lets the shaft kink by {once:.0f}, {twice:.0f} and {thrice:.0f} urad "
            f"once, twice and three times per turn"
        )


def effects(rig: RigConfig) -> tuple[Crack, ...]:
    """Return one at every place of a scan between the bearings; none where gravity does not bend the shaft."""
    if rig.gravity == "none":
        return ()
    left, right = span(rig)
    unknown = tuple(p for n in DIRECTIONS for p in pair(f"kink {n}X", "rad", most=1e-3, size=5e-5, order=n))
    return tuple(
        Crack(
            where=where,
            position=z,
            bending_stiffness=bending_stiffness(tube_at(rig, z)),
            gravity=rig.gravity,
            parameters=unknown,
        )
        for where, z in free_places(rig).items()
        if left < z < right
    )
