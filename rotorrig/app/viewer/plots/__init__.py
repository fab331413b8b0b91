"""Plots drawn with Rerun's 2D and 3D primitives, which has no XY view.

Axes, Bode, polar, orbit, cascade, rotor. One file each.
"""

from rotorrig.app.viewer.plots.against_speed import SpeedPicture
from rotorrig.app.viewer.plots.axes import DOWN, MARK, MODEL_DOWN, MODEL_UP, SOFT, UP
from rotorrig.app.viewer.plots.bode import BodePicture, Panels, fastest_rpm
from rotorrig.app.viewer.plots.cascade import CascadePicture
from rotorrig.app.viewer.plots.centreline import SMALLEST_PATH, CentrelinePicture
from rotorrig.app.viewer.plots.gap_trend import PROBE_COLOURS, GapTrendPicture
from rotorrig.app.viewer.plots.orbit import OrbitPicture
from rotorrig.app.viewer.plots.polar import PolarPicture, speed_marks
from rotorrig.app.viewer.plots.residual import ResidualPicture
from rotorrig.app.viewer.plots.rotor_3d import BACKWARD, FORWARD, LINE_LIKE, RotorPicture
from rotorrig.app.viewer.plots.time_base import TimeBasePicture
from rotorrig.app.viewer.plots.words import displayable

__all__ = [
    "BACKWARD",
    "DOWN",
    "FORWARD",
    "LINE_LIKE",
    "MARK",
    "MODEL_DOWN",
    "MODEL_UP",
    "PROBE_COLOURS",
    "SMALLEST_PATH",
    "SOFT",
    "UP",
    "BodePicture",
    "CascadePicture",
    "CentrelinePicture",
    "GapTrendPicture",
    "OrbitPicture",
    "Panels",
    "PolarPicture",
    "ResidualPicture",
    "RotorPicture",
    "SpeedPicture",
    "TimeBasePicture",
    "displayable",
    "fastest_rpm",
    "speed_marks",
]
