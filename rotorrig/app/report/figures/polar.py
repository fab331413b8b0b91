"""Polar plot of the 1X vectors of one probe: 0° of phase lag at the probe, lag against rotation.

A vector points to the high spot at the keyphasor edge, seen along the axis with x to the right and y up.
"""

import math
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from rotorrig.app.plot_data import Curve, curves, lag_degrees, model_path, nice, thin_curve, thin_indices
from rotorrig.app.report.figures.bode import DOTS
from rotorrig.app.report.figures.look import COLOURS, GRID, LINE, apply_look, base_line, dots, line, of_amplitudes
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig

HEIGHT = 430  # px, that of the Bode plot beside it
LABELLED = 7  # speeds along the first run
APART = 0.22  # of the largest amplitude: labels nearer to one another are left out


def polar(
    response: OrderTrackedResponse,
    probe: int,
    *,
    prediction: NDArray[np.complex128] | None = None,
    before: NDArray[np.complex128] | None = None,
    height: int = HEIGHT,
) -> go.Figure:
    """Return the paths of the 1X vectors over speed, in the colours and from the models of `bode`."""
    figure = go.Figure()
    for curve in curves(response, probe, prediction=before) if before is not None else ():
        _draw_model(figure, curve, base_line(curve.direction))
    drawn = curves(response, probe, prediction=prediction)
    for curve in drawn:
        few = thin_curve(curve, most=DOTS)
        _draw(figure, few.rpm, few.amplitude, few.lag, name=curve.run, look=dots(curve.direction, size=4))
        if prediction is not None:
            _draw_model(figure, curve, line(curve.direction))
    for curve in drawn[:1]:
        _label(figure, curve)
    apply_polar_look(figure, response.rig, response.probes[probe], height=height)
    if drawn:
        figure.update_polars(radialaxis=_radius(drawn[0], figure.layout.polar.angularaxis))
    return figure


def _radius(curve: Curve, axis: go.layout.polar.AngularAxis) -> dict[str, Any]:
    """Return the scale of the radius, out of a path's way: opposite to its largest vector; no number at the centre."""
    if not np.isfinite(curve.amplitude).any():
        return {}
    peak = int(np.nanargmax(curve.amplitude))
    sense = -1 if axis.direction == "clockwise" else 1
    opposite = axis.rotation + sense * float(curve.lag[peak]) + 180.0
    return {
        "angle": round(opposite / 30.0) * 30.0 % 360.0 + 15.0,  # between two lines of the grid
        "tickmode": "array",
        "tickvals": [nice(curve.amplitude[peak] / 3) * n for n in (1, 2, 3)],
    }


def apply_polar_look(figure: go.Figure, rig: RigConfig, probe: str, *, height: int) -> None:
    """Lay out a polar plot of a probe's vectors, by their phase lag."""
    angle = rig.probe(probe).angle
    apply_look(of_amplitudes(figure, "r"), height=height)
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
        radialaxis={
            "angle": math.degrees(angle) + 15,
            "gridcolor": GRID,
            "linecolor": LINE,
            "nticks": 4,
        },
    )


def _draw_model(figure: go.Figure, curve: Curve, look: dict[str, Any]) -> None:
    rpm, z = model_path(curve)
    kept = thin_indices(np.abs(z))
    _draw(figure, rpm[kept], np.abs(z[kept]), lag_degrees(z[kept]), name=curve.run, look=look)


def _draw(
    figure: go.Figure,
    rpm: NDArray[np.float64],
    amplitude: NDArray[np.float64],
    lag: NDArray[np.float64],
    *,
    name: str,
    look: dict[str, Any],
) -> None:
    figure.add_scatterpolar(
        r=np.round(amplitude, 3),
        theta=np.round(lag % 360.0, 1),
        customdata=np.round(rpm, 1),
        name=escape(name),
        hovertemplate="%{customdata:.0f} rpm: %{r:.2f} µm at %{theta:.1f}°<extra>" + escape(name) + "</extra>",
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
        marker={
            "size": 7,
            "symbol": "x-thin",
            "line": {"width": 1.5, "color": COLOURS[curve.direction]},  # which is all there is of a thin cross
        },
        hoverinfo="skip",
    )


def rows_to_label(curve: Curve) -> list[int]:
    """Return the rows whose speed is written beside them: the peak, and others spread over the vectors' path.

    None near the centre, where paths begin and end and labels would cover one another.
    """
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
        if all(abs(z[row] - other) > APART * abs(z[peak]) for other in (0.0, *z[kept])):
            kept.append(row)
    return kept
