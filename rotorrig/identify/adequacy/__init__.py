"""Adequacy of the model.

Tests of the whitened residual, the mean shaft position, and the misfit in the user's units.
"""

from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.adequacy.residual_tests import (
    Adequacy,
    assess,
    assess_all,
    scatter_test,
)
from rotorrig.identify.adequacy.row_scatter import excess_scatter
from rotorrig.identify.adequacy.settings import ADEQUACY

__all__ = [
    "ADEQUACY",
    "Adequacy",
    "Misfit",
    "assess",
    "assess_all",
    "excess_scatter",
    "scatter_test",
]
