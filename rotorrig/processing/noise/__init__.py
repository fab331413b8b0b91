"""Noise of order vectors: covariance from the spectrum between the order lines, and interference by mains hum."""

from rotorrig.processing.noise.mains_lines import line_remarks

__all__ = [
    "line_remarks",
]
