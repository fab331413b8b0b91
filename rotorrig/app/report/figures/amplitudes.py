"""The amplitude at one order against speed, a panel per probe."""

from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from rotorrig.app.plot_data import Curve, curves, thin_curve
from rotorrig.app.report.figures.look import COLOURS, apply_look, dots, of_amplitudes
from rotorrig.processing import OrderTrackedResponse

MOST = 160  # points of a run: a panel is half as wide as the page


def order_amplitudes(response: OrderTrackedResponse, order: float) -> go.Figure:
    """Return the amplitude at one order against speed, a panel per probe, with one sigma of its noise in grey."""
    rows = (len(response.probes) + 1) // 2
    figure = make_subplots(
        rows=rows,
        cols=min(2, len(response.probes)),
        shared_xaxes=True,
        subplot_titles=[escape(name) for name in response.probes],
        vertical_spacing=0.14 / max(rows - 1, 1),
        horizontal_spacing=0.1,
    )
    for p in range(len(response.probes)):
        place = {"row": p // 2 + 1, "col": p % 2 + 1}
        for i, curve in enumerate(thin_curve(c, most=MOST) for c in curves(response, p, order=order)):
            figure.add_trace(_amplitude_trace(curve, legend=p == 0), **place)
            if i == 0:
                figure.add_trace(_noise_trace(curve, legend=p == 0), **place)
    figure.update_yaxes(rangemode="tozero", title="µm 0-peak", col=1)
    figure.update_xaxes(title="speed, rpm", row=rows)
    apply_look(of_amplitudes(figure, "y"), height=80 + 210 * rows)
    figure.update_layout(legend_y=1.0 + 0.12 / rows, margin_t=56)  # above the panels' titles
    return figure


def _amplitude_trace(curve: Curve, *, legend: bool) -> go.Scatter:
    name = escape(curve.run)
    return go.Scatter(
        x=np.round(curve.rpm, 1),
        y=np.round(curve.amplitude, 3),
        name=name,
        legendgroup=name,
        showlegend=legend,
        hovertemplate=f"%{{x:.0f}} rpm: %{{y:.2f}} µm<extra>{name}</extra>",
        **dots(curve.direction),
    )


def _noise_trace(curve: Curve, *, legend: bool) -> go.Scatter:
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
