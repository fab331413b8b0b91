"""Adequacy of the model.

Tests of the whitened residual, the mean shaft position, and the misfit in the user's units.
"""

from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.adequacy.residual_tests import (
    Adequacy,
    assess,
)
from rotorrig.identify.adequacy.settings import ADEQUACY

__all__ = [
    "ADEQUACY",
    "Adequacy",
    "Misfit",
    "assess",
]
