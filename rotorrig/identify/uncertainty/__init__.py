"""Uncertainty of the estimates: sigmas and intervals, profile likelihood, bootstrap, what the data cannot tell.

And what they contradict: pulls of the nuisances, against the config's statements.
"""

from rotorrig.identify.uncertainty.bootstrap import Resampling, with_bootstrap_intervals
from rotorrig.identify.uncertainty.identifiability import Identifiability
from rotorrig.identify.uncertainty.identifiability_text import describe_identifiability
from rotorrig.identify.uncertainty.intervals import with_intervals
from rotorrig.identify.uncertainty.model_resonances import model_resonances
from rotorrig.identify.uncertainty.motion_columns import covariance_root, motion_with_columns
from rotorrig.identify.uncertainty.nameplate_pulls import check_nameplate, nuisance_pulls
from rotorrig.identify.uncertainty.settings import UNCERTAINTY

__all__ = [
    "UNCERTAINTY",
    "Identifiability",
    "Resampling",
    "check_nameplate",
    "covariance_root",
    "describe_identifiability",
    "model_resonances",
    "motion_with_columns",
    "nuisance_pulls",
    "with_bootstrap_intervals",
    "with_intervals",
]
