"""The simulated rig's physics, blind to the identifier.

Hidden truth, shaft, sensors, noise, faults, time integration.
"""

from rotorrig.sims.plant.draw import draw, identified_truth
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.truth import FaultSpec, Truth

__all__ = [
    "FaultSpec",
    "Plant",
    "Truth",
    "draw",
    "identified_truth",
    "seal",
    "unseal",
]
