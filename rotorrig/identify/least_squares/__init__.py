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
    inverse_information_root,
    solve,
    squared_distance,
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
    "inverse_information_root",
    "solve",
    "squared_distance",
    "take_step",
]
