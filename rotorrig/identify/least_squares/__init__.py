"""Bounded Levenberg-Marquardt with exact Jacobians, some parameters fixed, and its covariance."""

from rotorrig.identify.chea.residuals import LinearModel, Point, Stop, take_step
from rotorrig.identify.least_squares.solve import (
    LEAST_SQUARES,
    NONE_FIXED,
    Index,
    Solution,
    Worth,
    always,
    inverse_information,
    solve,
)

__all__ = [
    "LEAST_SQUARES",
    "NONE_FIXED",
    "Index",
    "LinearModel",
    "Point",
    "Solution",
    "Stop",
    "Worth",
    "always",
    "inverse_information",
    "solve",
    "take_step",
]
