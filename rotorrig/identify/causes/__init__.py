"""Which causes the residual calls for: candidates, score test, fits of single candidates, stepwise selection."""

from rotorrig.identify.causes.candidate_fit import Candidate, plausible
from rotorrig.identify.causes.candidates import background, candidates
from rotorrig.identify.causes.selection_step import Stage
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.stepwise_selection import Selection, called_for, select

__all__ = [
    "SELECTION",
    "Candidate",
    "Selection",
    "Stage",
    "background",
    "called_for",
    "candidates",
    "plausible",
    "select",
]
