"""Shaft centreline of one plane of probes, within the bearing clearance if known."""

from collections.abc import Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.plot_data import CentrelinePath, ClearanceCircle, is_seen_in
from rotorrig.app.report.figures.look import COLOURS, SHEER, apply_look

MOST = 250  # points of a path
HEIGHT = 420  # px


def centreline(paths: Sequence[CentrelinePath], circle: ClearanceCircle | None = None, *, reach: float) -> go.Figure:
    """Return the centreline of every run in one plane, x right and y up, on square axes of `reach` [µm] either way.

    They stand about the circle, or about where the path begins if it would be a dot in it.
    """
    figure = go.Figure()
    x = y = 0.0
    if circle is not None and is_seen_in(paths, circle):
        x, y = circle.x, circle.y
        _draw_circle(figure, circle)
    for path in paths:
        _draw(figure, path)
    figure.update_xaxes(title="x, µm", range=[x - reach, x + reach], constrain="domain")
    figure.update_yaxes(title="y, µm", range=[y - reach, y + reach], constrain="domain", scaleanchor="x")
    return apply_look(figure, height=HEIGHT)


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
