"""Plotly figures of the report: Bode, polar, centreline, residual and search maps. One figure per file."""

from rotorrig.app.report.figures.amplitudes import order_amplitudes
from rotorrig.app.report.figures.bode import bode
from rotorrig.app.report.figures.cascade import cascade
from rotorrig.app.report.figures.centreline import centreline
from rotorrig.app.report.figures.correction import correction_polar
from rotorrig.app.report.figures.maps import full_spectrum_map, residual_map, whirl_map
from rotorrig.app.report.figures.missing_force import force_over_motion, force_over_speed
from rotorrig.app.report.figures.polar import polar
from rotorrig.app.report.figures.predicted import predicted
from rotorrig.app.report.figures.search_map import search_map

__all__ = [
    "bode",
    "cascade",
    "centreline",
    "correction_polar",
    "force_over_motion",
    "force_over_speed",
    "full_spectrum_map",
    "order_amplitudes",
    "polar",
    "predicted",
    "residual_map",
    "search_map",
    "whirl_map",
]
