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
from rotorrig.sims.effects.found_force import FoundForce, found_force, slope_rows
from rotorrig.sims.effects.found_laws import DAMPING, FREQUENCY, LAWS, Law, ResonantForce
from rotorrig.sims.effects.found_reading import SHARES, FoundReading, found_reading
from rotorrig.sims.effects.internal_damping import InternalDamping
from rotorrig.sims.effects.line_hum import HARMONICS, MAINS, LineHum, leak
from rotorrig.sims.effects.rig_scale import RigScale
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.effects.unbalance_step import Stretch, UnbalanceStep

__all__ = [
    "DAMPING",
    "EVERY",
    "FREQUENCY",
    "HARMONICS",
    "LAWS",
    "MAINS",
    "SHARES",
    "Complex",
    "Effect",
    "FoundForce",
    "FoundReading",
    "InternalDamping",
    "Law",
    "LineHum",
    "Parameter",
    "ReadingContext",
    "ResonantForce",
    "RigScale",
    "Stretch",
    "Theta",
    "UnbalanceStep",
    "catalogue",
    "find",
    "forward",
    "found_force",
    "found_reading",
    "leak",
    "magnitudes",
    "position_rows",
    "slope_rows",
]
