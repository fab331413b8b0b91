"""Damping that turns with the shaft: the friction of shrink fits and set screws as the fibres are bent to and fro.

Stress = E (strain + time * strain rate) in axes fixed to the shaft. Seen from outside, the strain rate loses the part
that rotation alone makes of the bending: the force is time * K (q' - W x q), which drives forward whirl above the
speed w (1 + external / internal damping) (Kimball, Phil. Mag. 49 (1925) 724; Genta, Dynamics of Rotating
Systems (2005)).
"""

from dataclasses import replace

from scipy import linalg

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {"time": 5e-5}  # s, over and above the material's own
SIZE = ("time",)
RANGE = {"time": LogUniform(1e-5, 1.2e-4)}


def structure(rig: RigConfig, truth: Truth, rotor: Rotor, values: Values) -> Rotor:
    """Return `rotor` with more damping that turns."""
    more = values["time"] * rotor.shaft
    return replace(rotor, C=rotor.C + linalg.block_diag(more, more), D=rotor.D + more)
