"""Plots drawn with Rerun's 2D and 3D primitives, which has no XY view.

Axes, Bode, polar, orbit, cascades, rotor. One file each.
"""

from rotorrig.app.viewer.plots.against_speed import SpeedPicture
from rotorrig.app.viewer.plots.axes import (
    DOWN,
    INK,
    MARK,
    MODEL_DOWN,
    MODEL_UP,
    SOFT,
    UP,
    Colour,
    Panel,
    below_one_another,
    legend,
    pale,
    step_for,
)
from rotorrig.app.viewer.plots.bode import BodePicture, Panels, fastest_rpm
from rotorrig.app.viewer.plots.cascade import CascadePicture
from rotorrig.app.viewer.plots.centreline import CentrelinePicture
from rotorrig.app.viewer.plots.gap_trend import PROBE_COLOURS, GapTrendPicture
from rotorrig.app.viewer.plots.orbit import OrbitPicture
from rotorrig.app.viewer.plots.polar import PolarPicture, speed_marks
from rotorrig.app.viewer.plots.residual import ResidualPicture
from rotorrig.app.viewer.plots.rotor_3d import BACKWARD, FORWARD, LINE_LIKE, RotorPicture, merge_labels
from rotorrig.app.viewer.plots.spectrum_map import SpectrumMapPicture
from rotorrig.app.viewer.plots.time_base import TimeBasePicture
from rotorrig.app.viewer.plots.words import displayable

__all__ = [
    "BACKWARD",
    "DOWN",
    "FORWARD",
    "INK",
    "LINE_LIKE",
    "MARK",
    "MODEL_DOWN",
    "MODEL_UP",
    "PROBE_COLOURS",
    "SOFT",
    "UP",
    "BodePicture",
    "CascadePicture",
    "CentrelinePicture",
    "Colour",
    "GapTrendPicture",
    "OrbitPicture",
    "Panel",
    "Panels",
    "PolarPicture",
    "ResidualPicture",
    "RotorPicture",
    "SpectrumMapPicture",
    "SpeedPicture",
    "TimeBasePicture",
    "below_one_another",
    "displayable",
    "fastest_rpm",
    "legend",
    "merge_labels",
    "pale",
    "speed_marks",
    "step_for",
]
