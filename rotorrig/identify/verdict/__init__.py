"""What the diagnosis says: causes named, tied or unexplained, cross-validated gain, separability, the next run."""

from rotorrig.identify.verdict.cause import Cause, Figure
from rotorrig.identify.verdict.separability import NAMEABLE
from rotorrig.identify.verdict.sweep_lag import moving_speed
from rotorrig.identify.verdict.verdict import Verdict

__all__ = [
    "NAMEABLE",
    "Cause",
    "Figure",
    "Verdict",
    "moving_speed",
]
