"""Physics of the simulated rig, blind to the identifier: hidden truth, shaft, faults, time integration, sensors, noise.

`draw` a `Truth` from a seed, `seal` it, and let a `Plant` advance in time.
"""

from rotorrig.sims.plant.draw import draw, expected_estimates
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.truth import FaultSpec, Truth

__all__ = [
    "FaultSpec",
    "Plant",
    "Truth",
    "draw",
    "expected_estimates",
    "seal",
    "unseal",
]
