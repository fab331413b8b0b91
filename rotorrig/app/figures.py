"""The report's Plotly figures: Bode plots, residual maps, other orders.

Backgrounds are transparent and text and grid take their colour from the page (report.css), so that one figure serves
light, dark and print. Blue rises, orange falls, everywhere; both stay apart for colour-blind eyes.
"""

from html import escape

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from rotorrig.app.centreline_paths import CentrelinePath
from rotorrig.app.curves import Curve, curves, residual_grid, whirl_grid
from rotorrig.processing.response import OrderTrackedResponse

Reals = NDArray[np.float64]

COLOURS = {+1: "#3182bd", -1: "#e6792b", 0: "#808890"}  # speed rises, falls, neither
SIGMA_CEILING = 8.0  # of the residual map's colours: 8 sigma and 80 are equally wrong
#: calm to about 2 sigma, then ever louder
SIGMA_COLOURS: list[list[float | str]] = [
    [0.0, "rgba(128,136,144,0.10)"],
    [2.0 / SIGMA_CEILING, "rgba(128,136,144,0.35)"],
    [3.0 / SIGMA_CEILING, "#f2c14e"],
    [5.0 / SIGMA_CEILING, "#e6792b"],
    [1.0, "#b3123b"],
]
MICROMETRE_COLOURS: list[list[float | str]] = [[0.0, "rgba(128,136,144,0.10)"], [0.5, "#6aaed6"], [1.0, "#08306b"]]


def bode(
    response: OrderTrackedResponse,
    probe: int,
    *,
    prediction: NDArray[np.complex128] | None = None,
    before: NDArray[np.complex128] | None = None,
) -> go.Figure:
    """Return amplitude over phase lag against speed at 1X, measured (dots) and model (lines), a colour per direction.

    `prediction` is (speed, probe) [m] as `Fit.prediction`; None draws the measurement alone. `before` is that of the
    base model where `prediction` is an extended one's, a thin grey line.
    """
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.06, row_heights=[0.62, 0.38])
    for i, curve in enumerate(curves(response, probe, prediction=before) if before is not None else ()):
        figure.add_trace(_base(curve, curve.model_amplitude, legend=i == 0), row=1, col=1)
        figure.add_trace(_base(curve, curve.model_lag, angle=True, legend=False), row=2, col=1)
    for curve in curves(response, probe, prediction=prediction):
        figure.add_trace(_trace(curve, curve.amplitude), row=1, col=1)
        figure.add_trace(_trace(curve, curve.lag, angle=True, legend=False), row=2, col=1)
        if curve.model_amplitude is not None and curve.model_lag is not None:
            figure.add_trace(_trace(curve, curve.model_amplitude, modelled=True), row=1, col=1)
            figure.add_trace(_trace(curve, curve.model_lag, modelled=True, angle=True, legend=False), row=2, col=1)
    figure.update_yaxes(title="amplitude, µm 0-peak", rangemode="tozero", row=1, col=1)
    quarters = np.arange(-360, 811, 90)  # an axis may begin anywhere; its labels stay within 0 .. 360
    figure.update_yaxes(title="phase lag, °", tickvals=quarters, ticktext=quarters % 360, row=2, col=1)
    figure.update_xaxes(title="speed, rpm", row=2, col=1)
    return _styled(figure, height=430)


def residual_map(response: OrderTrackedResponse, sigmas: NDArray[np.float64], *, order: float = 1.0) -> go.Figure:
    """Return a map of the residual in standard deviations: speed across, a row per probe and run."""
    labels, edges, grid = residual_grid(response, sigmas, order=order)
    figure = _map(labels, edges, grid, unit="σ", ceiling=SIGMA_CEILING, colours=SIGMA_COLOURS)
    figure.data[0].colorbar.update(tickvals=[0, 2, 3, 5, 8], ticktext=["0", "2", "3", "5", "8 +"])
    return figure


def whirl_map(response: OrderTrackedResponse, residual: NDArray[np.complex128]) -> go.Figure | None:
    """Return a map of the 1X residual in µm as forward and backward whirl; None if no plane has two probes."""
    labels, edges, grid = whirl_grid(response, residual)
    if not labels:
        return None
    ceiling = float(np.max(grid, initial=0.0, where=np.isfinite(grid)))
    return _map(labels, edges, grid, unit="µm", ceiling=ceiling, colours=MICROMETRE_COLOURS)


def _map(
    labels: list[str], edges: Reals, grid: Reals, *, unit: str, ceiling: float, colours: list[list[float | str]]
) -> go.Figure:
    heat = go.Heatmap(
        x=edges,
        y=[escape(label) for label in labels],
        z=np.round(grid, 3),
        zmin=0,
        zmax=ceiling,
        colorscale=colours,
        ygap=2,
        hoverongaps=False,
        hovertemplate=f"%{{y}}, %{{x:.0f}} rpm: %{{z:.2f}} {unit}<extra></extra>",
        colorbar={"title": {"text": unit, "side": "top"}, "thickness": 12, "outlinewidth": 0},
    )
    figure = go.Figure(heat)
    figure.update_xaxes(title="speed, rpm", showgrid=False)
    figure.update_yaxes(autorange="reversed", showgrid=False, type="category")
    _styled(figure, height=110 + 26 * len(labels))
    figure.update_layout(modebar_orientation="h")  # above the map, not across its scale
    return figure


def order_amplitudes(response: OrderTrackedResponse, order: float) -> go.Figure:
    """Return the amplitude at one order against speed, a panel per probe, with one sigma of its noise in grey."""
    figure = make_subplots(
        rows=(len(response.probes) + 1) // 2,
        cols=min(2, len(response.probes)),
        shared_xaxes=True,
        subplot_titles=[escape(name) for name in response.probes],
        vertical_spacing=0.14,
        horizontal_spacing=0.1,
    )
    for p in range(len(response.probes)):
        place = {"row": p // 2 + 1, "col": p % 2 + 1}
        for i, curve in enumerate(curves(response, p, order=order)):
            figure.add_trace(_trace(curve, curve.amplitude, legend=p == 0), **place)
            if i == 0:
                figure.add_trace(_noise(curve, legend=p == 0), **place)
    figure.update_yaxes(rangemode="tozero", title="µm 0-peak", col=1)
    figure.update_xaxes(title="speed, rpm", row=(len(response.probes) + 1) // 2)
    _styled(figure, height=80 + 210 * ((len(response.probes) + 1) // 2))
    figure.update_layout(legend_y=1.06, margin_t=56)  # above the panels' titles
    return figure


def centreline(paths: tuple[CentrelinePath, ...]) -> go.Figure:
    """Return where the mean position of the shaft goes, x across and y up in one scale, a panel per plane."""
    planes = list(dict.fromkeys(path.plane for path in paths))
    figure = make_subplots(
        rows=1, cols=len(planes), subplot_titles=[escape(plane) for plane in planes], horizontal_spacing=0.12
    )
    for path in paths:
        column = planes.index(path.plane) + 1
        name = escape(path.run)
        figure.add_trace(
            go.Scatter(
                x=np.round(path.x, 3),
                y=np.round(path.y, 3),
                customdata=np.round(path.rpm),
                mode="markers",
                marker={"size": 4, "color": COLOURS[path.direction], "opacity": 0.6},
                name=name,
                legendgroup=name,
                showlegend=column == 1,
                hovertemplate=f"%{{customdata:.0f}} rpm: x %{{x:.2f}}, y %{{y:.2f}} µm<extra>{name}</extra>",
            ),
            row=1,
            col=column,
        )
        figure.update_yaxes(scaleanchor="x" if column == 1 else f"x{column}", row=1, col=column)
    figure.update_xaxes(title="x, µm")
    figure.update_yaxes(title="y, µm", col=1)
    _styled(figure, height=380)
    figure.update_layout(legend_y=1.08, margin_t=60)
    return figure


def _trace(
    curve: Curve, y: NDArray[np.float64], *, modelled: bool = False, angle: bool = False, legend: bool = True
) -> go.Scatter:
    """Return one run of a plot: dots if measured, a line if modelled; an angle is read out within 0 .. 360."""
    name = escape(curve.run) + (", model" if modelled else "")
    rising, colour = curve.direction > 0, COLOURS[curve.direction]
    look = (
        {"mode": "lines", "line": {"width": 1.8, "color": colour, "dash": "solid" if rising else "dash"}}
        if modelled
        # two symbols, so that two runs that agree are still seen to be two
        else {
            "mode": "markers",
            "marker": {"size": 5, "color": colour, "opacity": 0.6, "symbol": "circle" if rising else "circle-open"},
        }
    )
    reading = "%{customdata:.1f}°" if angle else "%{y:.2f} µm"
    return go.Scatter(
        x=np.round(curve.rpm, 1),
        y=np.round(y, 3),
        customdata=np.round(y % 360.0, 1) if angle else None,
        name=name,
        legendgroup=name,
        showlegend=legend,
        hovertemplate=f"%{{x:.0f}} rpm: {reading}<extra>{name}</extra>",
        **look,
    )


def _base(curve: Curve, y: NDArray[np.float64] | None, *, angle: bool = False, legend: bool) -> go.Scatter:
    """Return the base model's curve of one run."""
    assert y is not None
    reading = "%{customdata:.1f}°" if angle else "%{y:.2f} µm"
    return go.Scatter(
        x=np.round(curve.rpm, 1),
        y=np.round(y, 3),
        customdata=np.round(y % 360.0, 1) if angle else None,
        mode="lines",
        name="base model",
        legendgroup="base model",
        showlegend=legend,
        line={"width": 1.2, "color": COLOURS[0], "dash": "solid" if curve.direction > 0 else "dash"},
        hovertemplate=f"%{{x:.0f}} rpm: {reading}<extra>base model, {escape(curve.run)}</extra>",
    )


def _noise(curve: Curve, *, legend: bool) -> go.Scatter:
    return go.Scatter(
        x=np.round(curve.rpm, 1),
        y=np.round(curve.sigma, 4),
        mode="lines",
        name="noise, 1 σ",
        legendgroup="noise",
        showlegend=legend,
        line={"width": 1.2, "color": COLOURS[0], "dash": "dot"},
        hovertemplate="%{y:.3f} µm<extra>noise, 1 σ</extra>",
    )


def _styled(figure: go.Figure, *, height: int) -> go.Figure:
    """Strip Plotly's own look and give ours."""
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
    figure.update_xaxes(gridcolor="rgba(128,136,144,0.25)", zeroline=False, automargin=True)
    figure.update_yaxes(gridcolor="rgba(128,136,144,0.25)", zeroline=False, automargin=True)
    return figure
