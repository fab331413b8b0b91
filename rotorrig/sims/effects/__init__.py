"""Effects: the ways a real rig departs from its nameplate that the diagnosis knows, one file each, found by name.

base.py says how to write one; `catalogue(rig)` is all of them at every place of a rig.
"""

from rotorrig.sims.effects.base import (
    EVERY,
    Complex,
    Effect,
    Parameter,
    ReadingContext,
    Theta,
    catalogue,
    find,
    magnitudes,
)
from rotorrig.sims.effects.internal_damping import InternalDamping
from rotorrig.sims.effects.line_hum import leak
from rotorrig.sims.effects.unbalance_step import Stretch, UnbalanceStep

__all__ = [
    "EVERY",
    "Complex",
    "Effect",
    "InternalDamping",
    "Parameter",
    "ReadingContext",
    "Stretch",
    "Theta",
    "UnbalanceStep",
    "catalogue",
    "find",
    "leak",
    "magnitudes",
]
