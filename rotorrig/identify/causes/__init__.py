"""Which causes the residual calls for: candidates, score test, fits of single candidates, stepwise selection."""

from rotorrig.identify.causes.candidate_fit import Candidate, plausible
from rotorrig.identify.causes.candidates import background, candidates
from rotorrig.identify.causes.selection_step import DETECTED, Stage
from rotorrig.identify.causes.stepwise_selection import Selection, called_for, select

__all__ = [
    "DETECTED",
    "Candidate",
    "Selection",
    "Stage",
    "background",
    "called_for",
    "candidates",
    "plausible",
    "select",
]
