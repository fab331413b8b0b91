"""The rotor model with effects as a least-squares problem over one or more recordings.

Motion, measuring chain, Jacobian.
"""

from rotorrig.identify.extended_model.excited_rotor import Moving, halved_loads
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.nuisance_effects import MarkEdge, nuisance_effects
from rotorrig.identify.extended_model.parameters import KEYPHASOR, ExtendedParameters
from rotorrig.identify.extended_model.probe_curve import CURVED_AT, bend
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording, recordings_of

__all__ = [
    "CURVED_AT",
    "EXTENDED_MODEL",
    "KEYPHASOR",
    "ExtendedModel",
    "ExtendedParameters",
    "ExtendedProblem",
    "MarkEdge",
    "Moving",
    "Recording",
    "bend",
    "halved_loads",
    "nuisance_effects",
    "recordings_of",
]
