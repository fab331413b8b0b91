"""Polar plot of a correction at one probe: vectors before, vectors as predicted after, and how the largest is moved."""

import cmath
import math
from html import escape

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from rotorrig.app.report.figures.look import dots, line
from rotorrig.app.report.figures.polar import apply_polar_look
from rotorrig.balancing import DIRECTIONS, Prediction
from rotorrig.rig.config import RPM, UM, RigConfig

HEIGHT, SMALL = 320, 190  # px
MOVED = "#7b3294"  # the arrow: neither run-up nor run-down


def correction_polar(prediction: Prediction, probe: int, rig: RigConfig, *, small: bool = False) -> go.Figure:
    """Return the vectors of one probe over speed in the look of `polar`, and an arrow from before to after.

    A `small` one has fewer labels.
    """
    figure = go.Figure()
    for way in (1, -1, 0):
        rows = prediction.rows_of(probe, way)
        if rows.size:
            rpm = prediction.omega[rows] * RPM
            _draw(figure, prediction.before[rows], rpm, f"before, {DIRECTIONS[way]}", dots(way, size=4))
            after = line(way) if rows.size > 1 else dots(way, size=8)
            _draw(figure, prediction.after[rows], rpm, f"predicted, {DIRECTIONS[way]}", after)
    mine = np.flatnonzero(prediction.probe == probe)
    largest = mine[np.argmax(np.abs(prediction.before[mine]))]
    _draw_arrow(figure, prediction, int(largest))
    apply_polar_look(figure, rig, prediction.probes[probe], height=SMALL if small else HEIGHT)
    figure.update_polars(radialaxis_angle=_clear_of(figure, prediction.before[largest]))
    if small:
        figure.update_layout(margin={"l": 32, "r": 32, "t": 16, "b": 16}, font_size=9)
        figure.update_polars(angularaxis_dtick=90, radialaxis_nticks=3)
    return figure


def _draw(
    figure: go.Figure, z: NDArray[np.complex128], rpm: NDArray[np.float64], name: str, look: dict[str, object]
) -> None:
    figure.add_scatterpolar(
        r=np.round(np.abs(z) * UM, 3),
        theta=_lag(z),
        customdata=np.round(rpm, 1),
        name=escape(name),
        hovertemplate="%{customdata:.0f} rpm: %{r:.2f} µm at %{theta:.1f}°<extra>" + escape(name) + "</extra>",
        **look,
    )


def _clear_of(figure: go.Figure, z: complex) -> float:
    """Return the direction on paper [deg], from its right towards its top, a right angle before a vector's."""
    axis = figure.layout.polar.angularaxis
    sense = -1 if axis.direction == "clockwise" else 1
    return float((axis.rotation - sense * math.degrees(cmath.phase(z)) - 90.0) % 360.0)


def _draw_arrow(figure: go.Figure, prediction: Prediction, row: int) -> None:
    """Draw what the masses do to the vector of one entry."""
    z = np.array([prediction.before[row], prediction.after[row]])
    figure.add_scatterpolar(
        r=np.round(np.abs(z) * UM, 3),
        theta=_lag(z),
        mode="lines+markers+text",
        text=[f"{prediction.omega[row] * RPM:.0f} rpm", ""],
        textposition="bottom center",
        line={"width": 2.5, "color": MOVED},
        marker={"symbol": ["circle", "arrow"], "size": [7, 14], "angleref": "previous", "color": MOVED},
        hoverinfo="skip",
    )


def _lag(z: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.asarray(np.round(-np.degrees(np.angle(z)) % 360.0, 1))
