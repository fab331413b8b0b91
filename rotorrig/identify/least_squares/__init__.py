"""Bounded Levenberg-Marquardt with exact Jacobians, some parameters fixed, and its covariance."""

from rotorrig.identify.least_squares.levenberg_marquardt import TOLERANCE, LinearModel, Stop, Worth, always, take_step
from rotorrig.identify.least_squares.solve import NONE_FIXED, Index, Solution, inverse_information, solve

__all__ = [
    "NONE_FIXED",
    "TOLERANCE",
    "Index",
    "LinearModel",
    "Solution",
    "Stop",
    "Worth",
    "always",
    "inverse_information",
    "solve",
    "take_step",
]
