"""A bearing that pushes the shaft sideways, ahead in its whirl: what a fluid dragged round by the journal does.

The force on a shaft displaced by r stands a quarter turn ahead of r in the sense of rotation (Muszynska, J. Sound
Vib. 110 (1986) 443: fluid stiffness carried round at a fraction of the speed); it feeds forward whirl and damps
backward whirl. Here it does not depend on speed.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import sense, sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"stiffness": 1000.0}  # N/m; unstable above the bearing's damping times w: 3500 N/m
SIZE = ("stiffness",)
RANGE = {"stiffness": LogUniform(100.0, 1800.0)}


def deviations(rig: RigConfig, truth: Truth, values: Values) -> Truth:
    """Return `truth` with a sideways force in the bearings that are sought."""
    sought = {b.name for b in sought_bearings(rig)}
    k = sense(rig) * values["stiffness"]  # turning x to y, a shaft out along x is pushed along +y: -kyx > 0
    bearings = tuple(replace(b, kxy=b.kxy + k, kyx=b.kyx - k) if b.name in sought else b for b in truth.bearings)
    return replace(truth, bearings=bearings)
