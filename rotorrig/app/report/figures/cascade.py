"""Cascade of one place in one run: a map of its spectra, frequency across and speed up, with lines at shaft orders."""

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.plot_data import DECADES, SpeedSpectra, decibels, order_mark
from rotorrig.app.report.figures.look import apply_look

HEIGHT = 400  # px
COLOURS = "Magma"  # dark where nothing is, in every look of the page
LINE = "rgba(255,255,255,0.55)"


def cascade(spectra: SpeedSpectra, *, top: float) -> go.Figure:
    """Return the map; `top` [µm] is the amplitude of the brightest colour, one for all maps of a page.

    Amplitudes are drawn, and read, in whole decibels above 1 µm 0-peak: a byte each, or the page would be too large.
    """
    high = 20 * np.log10(top)
    low = high - 20 * DECADES
    ticks = np.arange(np.ceil(low / 20), np.floor(high / 20) + 1)
    figure = go.Figure(
        go.Heatmap(
            x0=float(spectra.frequency[0]),
            dx=spectra.step,
            y=np.round(spectra.rpm, 1),
            z=decibels(spectra.amplitude),
            zmin=low,
            zmax=high,
            colorscale=COLOURS,
            hovertemplate="%{x:.1f} Hz at %{y:.0f} rpm: %{z} dB above 1 µm<extra></extra>",
            colorbar={
                "title": {"text": "µm", "side": "top"},
                "thickness": 12,
                "outlinewidth": 0,
                "tickvals": 20 * ticks,
                "ticktext": [f"{10.0**tick:g}" for tick in ticks],
            },
        )
    )
    _draw_orders(figure, spectra)
    apply_look(figure, height=HEIGHT)
    ends = [float(spectra.frequency[0] - spectra.step / 2), float(spectra.frequency[-1] + spectra.step / 2)]
    sides = "Hz; backward whirl below 0" if spectra.full else "Hz"
    figure.update_xaxes(title=sides, showgrid=False, range=ends)
    figure.update_yaxes(title="speed, rpm", showgrid=False, range=[float(spectra.rpm.min()), float(spectra.rpm.max())])
    figure.update_layout(showlegend=False, modebar_orientation="h")
    return figure


def _draw_orders(figure: go.Figure, spectra: SpeedSpectra) -> None:
    """Draw a dotted line at each order, labelled where it ends above, fractions above the others."""
    slow, fast = float(spectra.rpm.min()), float(spectra.rpm.max())
    for order in spectra.orders:
        figure.add_scatter(
            x=[round(order * rpm / 60, 2) for rpm in (slow, fast)],
            y=[round(slow, 1), round(fast, 1)],
            mode="lines",
            line={"width": 1, "color": LINE, "dash": "dot"},
            hoverinfo="skip",
        )
        figure.add_annotation(
            x=order * fast / 60,
            y=fast,
            text=order_mark(order),
            showarrow=False,
            yanchor="bottom",
            yshift=12 if abs(order) < 1 else 0,
            font={"size": 11},
        )
