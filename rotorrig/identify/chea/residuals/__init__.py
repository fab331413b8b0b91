"""CHEA for residual vectors: multistart Levenberg-Marquardt, valleys, and least absolute values by linear programs."""

from rotorrig.identify.chea.residuals.least_absolute import descend_absolute
from rotorrig.identify.chea.residuals.levenberg_marquardt import (
    FIT,
    SEARCH,
    Counted,
    Evaluate,
    Minimum,
    Point,
    Progress,
    Residual,
    Settings,
    Stop,
    minimize_squares,
    take_step,
)
from rotorrig.identify.chea.residuals.linear_model import LinearModel, triangular_factor
from rotorrig.identify.chea.residuals.residual_search import RESIDUAL, ResidualResult, ResidualSettings, residual_search

__all__ = [
    "FIT",
    "RESIDUAL",
    "SEARCH",
    "Counted",
    "Evaluate",
    "LinearModel",
    "Minimum",
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
