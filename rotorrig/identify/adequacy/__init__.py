"""Is the model good enough.

Tests of the whitened residual, the mean shaft position, and the misfit in the user's units.
"""

from rotorrig.identify.adequacy.misfit import Misfit
from rotorrig.identify.adequacy.residual_tests import (
    FALSE_ALARM_RATE,
    FOCUSED_LIMIT,
    GLOBAL_LIMIT,
    STRETCH,
    Adequacy,
    assess,
)

__all__ = [
    "FALSE_ALARM_RATE",
    "FOCUSED_LIMIT",
    "GLOBAL_LIMIT",
    "STRETCH",
    "Adequacy",
    "Misfit",
    "assess",
]
