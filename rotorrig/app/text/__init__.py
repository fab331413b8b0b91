"""Results in words, shared by terminal, report and viewer: quantities with units, causes, the quality of a tracking."""

from rotorrig.app.text.quantities import (
    SHOWN,
    UNDETERMINED,
    at_bound,
    bearing_coefficients,
    change,
    determined,
    in_sigmas,
    interval,
    long,
    plus_minus,
    plus_minus_of,
    probability,
    shown,
)
from rotorrig.app.text.tracking import quality_words, spacing_words, tracked_facts, tracked_words

__all__ = [
    "SHOWN",
    "UNDETERMINED",
    "at_bound",
    "bearing_coefficients",
    "change",
    "determined",
    "in_sigmas",
    "interval",
    "long",
    "plus_minus",
    "plus_minus_of",
    "probability",
    "quality_words",
    "shown",
    "spacing_words",
    "tracked_facts",
    "tracked_words",
]
