"""Search for the causes of a misfit: candidates, score test, fits of single candidates, stepwise selection."""

from rotorrig.identify.causes.candidate_fit import (
    Candidate,
    finish,
    fit_candidate,
    plausible,
    price,
    refit,
    relocate_last_effect,
)
from rotorrig.identify.causes.candidates import candidates, scale_of
from rotorrig.identify.causes.pinned_nuisances import fit_with_pinned_nuisances, nuisances_biased
from rotorrig.identify.causes.score_jacobian import responses_to
from rotorrig.identify.causes.score_test import Score, projection, scores
from rotorrig.identify.causes.selection_step import SelectionStep
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.stepwise_selection import Selection, is_significant, leave_out, select

__all__ = [
    "SELECTION",
    "Candidate",
    "Score",
    "Selection",
    "SelectionStep",
    "candidates",
    "finish",
    "fit_candidate",
    "fit_with_pinned_nuisances",
    "is_significant",
    "leave_out",
    "nuisances_biased",
    "plausible",
    "price",
    "projection",
    "refit",
    "relocate_last_effect",
    "responses_to",
    "scale_of",
    "scores",
    "select",
]
