"""Amplitude over phase lag against speed, measured and modelled, of one probe."""

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from rotorrig.app.plot_data import CriticalSpeed, Curve, curves, thin_curve
from rotorrig.app.report.figures.look import COLOURS, apply_look, base_line, dots, line, of_amplitudes
from rotorrig.app.text import resonance_text
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM

HEIGHT = 430  # px
APART = 1.04  # of one another: critical speeds further apart are labelled by themselves
LOWER = 0.3  # of the panel: the height of a label
MARKED = 2  # of a group: more runs would fill the plot
DOTS = 160  # of a run: more would hide the line of the model


def bode(
    response: OrderTrackedResponse,
    probe: int,
    *,
    prediction: NDArray[np.complex128] | None = None,
    before: NDArray[np.complex128] | None = None,
    resonances: Sequence[CriticalSpeed] = (),
    height: int = HEIGHT,
) -> go.Figure:
    """Return amplitude over phase lag against speed at 1X, measured (dots) and model (lines), a colour per direction.

    `prediction` is (speed, probe) [m] as `Fit.prediction`; None draws the measurement alone. `before` is that of the
    base model where `prediction` is an extended one's, a thin grey line; `resonances` are those of the probe to mark.
    Of amplitudes alone there is no lower panel.
    """
    heights = [1.0] if response.amplitudes_alone else [0.62, 0.38]
    figure = make_subplots(rows=len(heights), cols=1, shared_xaxes=True, vertical_spacing=0.06, row_heights=heights)
    for i, curve in enumerate(curves(response, probe, prediction=before) if before is not None else ()):
        _draw_model(figure, curve, name="base model", legend=i == 0, look=base_line(curve.direction))
    for curve in curves(response, probe, prediction=prediction):
        name, few = escape(curve.run), thin_curve(curve, most=DOTS)
        _draw(figure, few.rpm, few.amplitude, few.lag, name=name, legend=True, look=dots(curve.direction))
        if prediction is not None:
            _draw_model(figure, curve, name=f"{name}, model", legend=True, look=line(curve.direction))
    figure.update_yaxes(title="µm 0-peak", rangemode="tozero", row=1, col=1)
    if not response.amplitudes_alone:
        quarters = np.arange(-360, 811, 90)  # an axis may begin anywhere; its labels stay within 0 .. 360
        figure.update_yaxes(title="lag, °", tickvals=quarters, ticktext=quarters % 360, row=2, col=1)
    figure.update_xaxes(title="speed, rpm", row=len(heights), col=1)
    apply_look(of_amplitudes(figure, "y", axes=["y"]), height=height)
    _mark(figure, resonances)
    return figure


def _mark(figure: go.Figure, resonances: Sequence[CriticalSpeed]) -> None:
    """Draw a line at every critical speed; those of several runs are labelled together, on the side with more room."""
    rpm = np.concatenate([np.asarray(trace.x, dtype=float) for trace in figure.data])
    groups: list[list[CriticalSpeed]] = []
    for each in sorted(resonances, key=lambda each: each.measured.omega.value):
        speed = each.measured.omega.value * RPM
        look = {"width": 1, "color": COLOURS[each.direction], "dash": "dot"}
        figure.add_vline(speed, line=look, layer="below", row="all", col=1)
        if groups and speed < APART * groups[-1][-1].measured.omega.value * RPM:
            groups[-1].append(each)
        else:
            groups.append([each])
    for i, group in enumerate(groups):
        first, last = (each.measured.omega.value * RPM for each in (group[0], group[-1]))
        rightwards = np.nanmax(rpm) - last > first - np.nanmin(rpm)
        figure.add_annotation(
            x=last if rightwards else first,
            y=1 - LOWER * min(i, 2),  # no label covers the one before
            yref="y domain",
            xanchor="left" if rightwards else "right",
            yanchor="top",
            align="left" if rightwards else "right",
            text="<br>".join(_mark_text(each) for each in group[:MARKED]),
            showarrow=False,
            font={"size": 11},
        )


def _mark_text(found: CriticalSpeed) -> str:
    return f"{escape(found.run)} {resonance_text(found.measured).replace(', ', '<br>', 1)}"


def _draw_model(figure: go.Figure, curve: Curve, *, name: str, legend: bool, look: dict[str, Any]) -> None:
    few = thin_curve(curve, modelled=True)
    assert few.model_amplitude is not None and few.model_lag is not None
    _draw(figure, few.rpm, few.model_amplitude, few.model_lag, name=name, legend=legend, look=look)


def _draw(
    figure: go.Figure,
    rpm: NDArray[np.float64],
    amplitude: NDArray[np.float64],
    lag: NDArray[np.float64],
    *,
    name: str,
    legend: bool,
    look: dict[str, Any],
) -> None:
    """Draw one curve into both panels; a lag is read out within 0 .. 360, and none into a single panel."""
    shared = {"x": np.round(rpm, 1), "name": name, "legendgroup": name, **look}
    read = "%{x:.0f} rpm: %{y:.2f} µm<extra>" + name + "</extra>"
    figure.add_scatter(y=np.round(amplitude, 3), showlegend=legend, hovertemplate=read, row=1, col=1, **shared)
    if not np.isfinite(lag).any():
        return
    read = "%{x:.0f} rpm: %{customdata:.1f}°<extra>" + name + "</extra>"
    figure.add_scatter(
        y=np.round(lag, 1),
        customdata=np.round(lag % 360.0, 1),
        showlegend=False,
        hovertemplate=read,
        row=2,
        col=1,
        **shared,
    )
