"""Common look of the report's figures.

Backgrounds are transparent and text takes its colour from the page (report.css), so that one figure serves light, dark
and print. Blue is run-up, orange run-down; the pair is safe for colour-blind readers.
"""

from collections.abc import Sequence
from typing import Any

import plotly.graph_objects as go

COLOURS = {+1: "#3182bd", -1: "#e6792b", 0: "#808890"}  # speed rises, falls, neither
SHEER = {+1: "rgba(49,130,189,0.65)", -1: "rgba(230,121,43,0.75)", 0: "rgba(128,136,144,0.6)"}  # the same for dots
GRID = "rgba(128,136,144,0.25)"
LINE = "rgba(128,136,144,0.6)"


def apply_look(figure: go.Figure, *, height: int) -> go.Figure:
    """Replace Plotly's default look."""
    figure.update_layout(
        template="none",
        height=height,
        margin={"l": 62, "r": 14, "t": 34, "b": 46},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"family": "system-ui, sans-serif", "size": 12},
        legend={
            "orientation": "h",
            "y": 1.0,
            "yanchor": "bottom",
            "x": 0.0,
            "bgcolor": "rgba(0,0,0,0)",
            "itemsizing": "constant",
        },
        hovermode="closest",
        dragmode="zoom",
        modebar={"orientation": "v", "bgcolor": "rgba(0,0,0,0)"},
    )
    figure.update_xaxes(gridcolor=GRID, zeroline=False, automargin=True)
    figure.update_yaxes(gridcolor=GRID, zeroline=False, automargin=True)
    return figure


def of_amplitudes(figure: go.Figure, values: str, *, axes: Sequence[str] = ()) -> go.Figure:
    """Say which values of a figure's traces, "y", "r" or "z", are amplitudes in µm 0-peak, for units.js.

    Those of the traces on these `axes`, "y", or of all.
    """
    figure.update_layout(meta={"amplitude": values} | ({"axes": list(axes)} if axes else {}))
    return figure


def dots(direction: int, *, size: float = 4.5) -> dict[str, Any]:
    """Return the look of a measurement: dots, filled where the speed rises and hollow where it falls.

    Two symbols keep coinciding runs distinguishable.
    """
    symbol = "circle-open" if direction < 0 else "circle"
    marker = {"size": size, "color": SHEER[direction], "opacity": 1.0, "symbol": symbol}
    return {"mode": "markers", "marker": marker}


def line(direction: int) -> dict[str, Any]:
    """Return the look of a model: a line, dashed where the speed falls."""
    dash = "dash" if direction < 0 else "solid"
    return {"mode": "lines", "line": {"width": 1.5, "color": COLOURS[direction], "dash": dash}}


def base_line(direction: int) -> dict[str, Any]:
    """Return the look of the base model where an extended one stands beside it: thin and grey."""
    dash = "dash" if direction < 0 else "solid"
    return {"mode": "lines", "line": {"width": 1.2, "color": COLOURS[0], "dash": dash}}
