"""The noise of tracked vectors: covariance from neighbouring lines and repeats, interference from the mains."""

from rotorrig.processing.noise.mains_lines import line_remarks

__all__ = [
    "line_remarks",
]
