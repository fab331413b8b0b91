"""CHEA for residual vectors: multistart Levenberg-Marquardt, valleys, and least absolute values by linear programs."""

from rotorrig.identify.chea.residuals.least_absolute import descend_absolute
from rotorrig.identify.chea.residuals.levenberg_marquardt import Counted, descend, evaluate
from rotorrig.identify.chea.residuals.residual_search import RESIDUAL, ResidualSettings, residual_search

__all__ = [
    "RESIDUAL",
    "Counted",
    "ResidualSettings",
    "descend",
    "descend_absolute",
    "evaluate",
    "residual_search",
]
