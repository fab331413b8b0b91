"""Shaft centreline of one plane of probes, within the bearing clearance if known."""

from collections.abc import Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.plot_data import CentrelinePath, ClearanceCircle
from rotorrig.app.report.figures.look import COLOURS, SHEER, apply_look

MOST = 250  # points of a path
SEEN = 0.02  # of the circle's radius: a shorter path would be a dot in it, and is drawn without it


def centreline(paths: Sequence[CentrelinePath], circle: ClearanceCircle | None = None) -> go.Figure:
    """Return the centreline of every run in one plane, x right and y up at one scale."""
    figure = go.Figure()
    if circle is not None and seen_in(paths, circle):
        _draw_circle(figure, circle)
    for path in paths:
        _draw(figure, path)
    figure.update_xaxes(title="x, µm")
    figure.update_yaxes(title="y, µm", scaleanchor="x")
    return apply_look(figure, height=380)


def seen_in(paths: Sequence[CentrelinePath], circle: ClearanceCircle) -> bool:
    """Return whether the paths are large enough to be seen in the circle."""
    return any(np.hypot(path.x, path.y).max() > SEEN * circle.radius for path in paths)


def _draw_circle(figure: go.Figure, circle: ClearanceCircle) -> None:
    angle = np.linspace(0.0, 2 * np.pi, 181)
    figure.add_scatter(
        x=np.round(circle.x + circle.radius * np.cos(angle), 3),
        y=np.round(circle.y + circle.radius * np.sin(angle), 3),
        mode="lines",
        line={"width": 1.2, "color": COLOURS[0]},
        name=f"clearance of {escape(circle.bearing)}",
        hoverinfo="name",
    )


def _draw(figure: go.Figure, path: CentrelinePath) -> None:
    name = escape(path.run)
    some = slice(None, None, max(1, len(path.x) // MOST))
    figure.add_scatter(
        x=np.round(path.x[some], 3),
        y=np.round(path.y[some], 3),
        customdata=np.round(path.rpm[some]),
        mode="markers",
        marker={"size": 4, "color": SHEER[path.direction], "opacity": 1.0},
        name=name,
        hovertemplate=f"%{{customdata:.0f}} rpm: x %{{x:.2f}}, y %{{y:.2f}} µm<extra>{name}</extra>",
    )
