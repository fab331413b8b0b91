"""Polar plot of the 1X vectors of one probe: 0° of phase lag at the probe, lag against rotation.

A vector points to the high spot at the keyphasor edge, seen along the axis with x to the right and y up.
"""

import math
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from rotorrig.app.plot_data import Curve, curves, thin_curve
from rotorrig.app.report.figures.bode import DOTS
from rotorrig.app.report.figures.look import COLOURS, GRID, LINE, apply_look, base_line, dots, line
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig

HEIGHT = 430  # px, that of the Bode plot beside it
LABELLED = 7  # speeds along the first run
APART = 0.16  # of the largest amplitude: labels nearer to one another are left out


def polar(
    response: OrderTrackedResponse,
    probe: int,
    *,
    prediction: NDArray[np.complex128] | None = None,
    before: NDArray[np.complex128] | None = None,
) -> go.Figure:
    """Return the paths of the 1X vectors over speed, in the colours and from the models of `bode`."""
    figure = go.Figure()
    for curve in curves(response, probe, prediction=before) if before is not None else ():
        few = thin_curve(curve, modelled=True)
        _draw(figure, few, few.model_amplitude, few.model_lag, base_line(curve.direction))
    drawn = curves(response, probe, prediction=prediction)
    for curve in drawn:
        few = thin_curve(curve, most=DOTS)
        _draw(figure, few, few.amplitude, few.lag, dots(curve.direction, size=4))
        if prediction is not None:
            few = thin_curve(curve, modelled=True)
            _draw(figure, few, few.model_amplitude, few.model_lag, line(curve.direction))
    for curve in drawn[:1]:
        _label(figure, curve)
    apply_polar_look(figure, response.rig, response.probes[probe], height=HEIGHT)
    return figure


def apply_polar_look(figure: go.Figure, rig: RigConfig, probe: str, *, height: int) -> None:
    """Lay out a polar plot of a probe's vectors, by their phase lag."""
    angle = rig.probe(probe).angle
    apply_look(figure, height=height)
    figure.update_layout(margin={"l": 40, "r": 40, "t": 34, "b": 46}, showlegend=False, modebar_orientation="h")
    figure.update_polars(
        bgcolor="rgba(0,0,0,0)",
        angularaxis={
            "direction": "clockwise" if rig.rotation == "x-to-y" else "counterclockwise",
            "rotation": math.degrees(angle),
            "dtick": 30,
            "ticksuffix": "°",
            "gridcolor": GRID,
            "linecolor": LINE,
        },
        radialaxis={"angle": math.degrees(angle) + 15, "gridcolor": GRID, "linecolor": LINE, "nticks": 4},
    )


def _draw(
    figure: go.Figure,
    curve: Curve,
    amplitude: NDArray[np.float64] | None,
    lag: NDArray[np.float64] | None,
    look: dict[str, Any],
) -> None:
    if amplitude is None or lag is None:
        return
    figure.add_scatterpolar(
        r=np.round(amplitude, 3),
        theta=np.round(lag % 360.0, 1),
        customdata=np.round(curve.rpm, 1),
        name=escape(curve.run),
        hovertemplate="%{customdata:.0f} rpm: %{r:.2f} µm at %{theta:.1f}°<extra>" + escape(curve.run) + "</extra>",
        **look,
    )


def _label(figure: go.Figure, curve: Curve) -> None:
    """Write a few speeds along a run, its peak first."""
    rows = rows_to_label(curve)
    figure.add_scatterpolar(
        r=np.round(curve.amplitude[rows], 3),
        theta=np.round(curve.lag[rows] % 360.0, 1),
        text=[f"{curve.rpm[row]:.0f}" for row in rows],
        mode="markers+text",
        textposition="top right",
        textfont={"size": 11},
        marker={"size": 7, "color": COLOURS[curve.direction], "symbol": "x-thin", "line": {"width": 1.5}},
        hoverinfo="skip",
    )


def rows_to_label(curve: Curve) -> list[int]:
    """Return the rows whose speed is written beside them: the peak, and others spread over the vectors' path."""
    usable = np.flatnonzero(np.isfinite(curve.amplitude))
    if not usable.size:
        return []
    z = curve.amplitude * np.exp(-1j * np.radians(curve.lag))
    peak = int(usable[np.argmax(curve.amplitude[usable])])
    wanted = np.linspace(curve.rpm[usable].min(), curve.rpm[usable].max(), LABELLED)
    near_peak = curve.rpm[peak] * np.array([0.95, 0.98, 1.02, 1.05])
    kept = [peak]
    for speed in (*near_peak, *wanted):
        row = int(usable[np.argmin(np.abs(curve.rpm[usable] - speed))])
        if all(abs(z[row] - z[other]) > APART * abs(z[peak]) for other in kept):
            kept.append(row)
    return kept
