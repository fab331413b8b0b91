"""Uncertainty of the estimates: sigmas and intervals, profile likelihood, bootstrap, what the data cannot tell."""

from rotorrig.identify.uncertainty.bootstrap import Resampling, with_bootstrap_intervals
from rotorrig.identify.uncertainty.identifiability import Identifiability
from rotorrig.identify.uncertainty.identifiability_text import describe_identifiability
from rotorrig.identify.uncertainty.intervals import with_intervals

__all__ = [
    "Identifiability",
    "Resampling",
    "describe_identifiability",
    "with_bootstrap_intervals",
    "with_intervals",
]
