"""Effects, the ways a real rig departs from its nameplate that the diagnosis knows: one file each, found by name."""

from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, Seen, Theta, catalogue, find, magnitudes
from rotorrig.sims.effects.internal_damping import InternalDamping
from rotorrig.sims.effects.line_hum import leak
from rotorrig.sims.effects.unbalance_step import Stretch, UnbalanceStep

__all__ = [
    "EVERY",
    "Complex",
    "Effect",
    "InternalDamping",
    "Parameter",
    "Seen",
    "Stretch",
    "Theta",
    "UnbalanceStep",
    "catalogue",
    "find",
    "leak",
    "magnitudes",
]
