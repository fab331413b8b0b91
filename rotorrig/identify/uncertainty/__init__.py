"""How well the estimates are known: sigmas and intervals, profile likelihood, bootstrap, what the data cannot tell."""

from rotorrig.identify.uncertainty.bootstrap import Resampling, resampled
from rotorrig.identify.uncertainty.identifiability import Identifiability
from rotorrig.identify.uncertainty.identifiability_text import words
from rotorrig.identify.uncertainty.intervals import with_intervals

__all__ = [
    "Identifiability",
    "Resampling",
    "resampled",
    "with_intervals",
    "words",
]
