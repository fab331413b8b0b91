"""A missing force over speed, as measured and by the law found for it, and against the motion of its place."""

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from rotorrig.app.report.figures.look import COLOURS, GRID, apply_look
from rotorrig.identify.discovery import ForceOverSpeed
from rotorrig.rig.config import RPM, UM

HEIGHT = 380  # px
SENSES = (("turns with the shaft", COLOURS[1], "circle"), ("turns against it", COLOURS[-1], "circle-open"))
SEEN = 2.0  # sigmas: a phase is shown of what is larger


def force_over_speed(over: ForceOverSpeed, unit: str) -> go.Figure:
    """Return size with its 95 % interval, and phase lag, over speed; lines as the law says."""
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, row_heights=[0.62, 0.38], vertical_spacing=0.06)
    rpm = np.round(over.omega * RPM, 1)
    for i, (name, colour, symbol) in enumerate(SENSES):
        force, law, sigma = over.force[:, i], over.law[:, i], over.sigma[:, i]
        look = {"size": 5, "color": colour, "symbol": symbol}
        bars = {"array": _short(1.96 * sigma), "thickness": 1, "width": 0, "color": colour}
        figure.add_scatter(
            x=rpm, y=_short(np.abs(force)), error_y=bars, mode="markers", marker=look, name=name, row=1, col=1
        )
        line = {"color": colour, "width": 1.5}
        figure.add_scatter(
            x=rpm, y=_short(np.abs(law)), mode="lines", line=line, name=f"{name}, by the law", row=1, col=1
        )
        seen = np.abs(force) > SEEN * sigma
        lag = np.where(seen, -np.degrees(np.angle(force)) % 360, np.nan)
        figure.add_scatter(
            x=rpm, y=np.round(lag, 1), mode="markers", marker=look, showlegend=False, name=name, row=2, col=1
        )
    apply_look(figure, height=HEIGHT)
    figure.update_yaxes(title=f"force, {unit} 0-peak", rangemode="tozero", row=1, col=1)
    figure.update_yaxes(title="phase lag, deg", tickvals=[0, 90, 180, 270, 360], range=[0, 360], row=2, col=1)
    figure.update_xaxes(title="speed, rpm", row=2, col=1)
    return figure


def force_over_motion(over: ForceOverSpeed, unit: str) -> go.Figure:
    """Return the size of what turns with the shaft against that of the motion, dots by speed; the law in rings."""
    figure = go.Figure()
    motion, rpm = np.round(np.abs(over.motion[:, 0]) * UM, 3), np.round(over.omega * RPM)
    figure.add_scatter(
        x=motion,
        y=_short(np.abs(over.force[:, 0])),
        mode="markers",
        name="measured",
        marker={
            "size": 7,
            "color": rpm,
            "colorscale": "Viridis",
            "colorbar": {"title": {"text": "rpm"}, "thickness": 10, "outlinewidth": 0},
        },
    )
    ring = {"size": 9, "color": COLOURS[0], "symbol": "circle-open", "line": {"width": 1.2}}
    figure.add_scatter(x=motion, y=_short(np.abs(over.law[:, 0])), mode="markers", name="by the law", marker=ring)
    apply_look(figure, height=HEIGHT)
    figure.update_xaxes(title="motion of the place at 1X, µm 0-peak", rangemode="tozero", gridcolor=GRID)
    figure.update_yaxes(title=f"force that turns with the shaft, {unit} 0-peak", rangemode="tozero")
    return figure


def _short(values: np.ndarray) -> list[float]:
    return [float(f"{value:.4g}") for value in values]
