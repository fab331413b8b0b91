"""CHEA for residual vectors: descents by Levenberg-Marquardt or linear programs, and the parts of a search by them."""

from rotorrig.identify.chea.residuals.least_absolute import descend_absolute
from rotorrig.identify.chea.residuals.levenberg_marquardt import (
    FIT,
    SEARCH,
    Minimum,
    Progress,
    Settings,
    Stop,
    minimize_squares,
    take_step,
)
from rotorrig.identify.chea.residuals.linear_model import LinearModel, triangular_factor
from rotorrig.identify.chea.residuals.norms import ABSOLUTES, SQUARES, Norm
from rotorrig.identify.chea.residuals.point import Counted, Evaluate, Point, Residual
from rotorrig.identify.chea.residuals.residual_search import ResidualResult, residual_search
from rotorrig.identify.chea.residuals.vector import RESIDUAL, ResidualSettings

__all__ = [
    "ABSOLUTES",
    "FIT",
    "RESIDUAL",
    "SEARCH",
    "SQUARES",
    "Counted",
    "Evaluate",
    "LinearModel",
    "Minimum",
    "Norm",
    "Point",
    "Progress",
    "Residual",
    "ResidualResult",
    "ResidualSettings",
    "Settings",
    "Stop",
    "descend_absolute",
    "minimize_squares",
    "residual_search",
    "take_step",
    "triangular_factor",
]
