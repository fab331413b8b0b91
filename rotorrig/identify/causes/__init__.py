"""Search for the causes of a misfit: candidates, score test, fits of single candidates, stepwise selection."""

from rotorrig.identify.causes.candidate_fit import Candidate, plausible, price
from rotorrig.identify.causes.candidates import candidates
from rotorrig.identify.causes.selection_step import SelectionStep
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.stepwise_selection import Selection, is_significant, leave_out, select

__all__ = [
    "SELECTION",
    "Candidate",
    "Selection",
    "SelectionStep",
    "candidates",
    "is_significant",
    "leave_out",
    "plausible",
    "price",
    "select",
]
