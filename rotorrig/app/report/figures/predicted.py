"""Amplitude over speed at one probe, before and as predicted with masses on, with the 95 % band."""

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.report.figures.look import COLOURS, SHEER, apply_look, dots, line, of_amplitudes
from rotorrig.balancing import DIRECTIONS, Prediction
from rotorrig.rig.config import RPM, UM

HEIGHT, SMALL = 320, 132  # px


def predicted(prediction: Prediction, probe: int, *, small: bool = False) -> go.Figure:
    """Return the figure of one probe: dots as measured, a line and its band as predicted; no legend if `small`."""
    figure = go.Figure()
    low, high = prediction.band
    for way in (1, -1, 0):
        rows = prediction.rows_of(probe, way)
        if not rows.size:
            continue
        rpm = np.round(prediction.omega[rows] * RPM, 1)
        figure.add_scatter(
            x=np.concatenate([rpm, rpm[::-1]]),
            y=np.round(np.concatenate([high[rows], low[rows][::-1]]) * UM, 3),
            fill="toself",
            fillcolor=SHEER[way].replace("0.65", "0.2").replace("0.75", "0.2").replace("0.6)", "0.2)"),
            line={"width": 0, "color": COLOURS[way]},
            name=f"95 %, {DIRECTIONS[way]}",
            hoverinfo="skip",
        )
        before, after = (np.round(np.abs(z[rows]) * UM, 3) for z in (prediction.before, prediction.after))
        figure.add_scatter(x=rpm, y=before, name=f"before, {DIRECTIONS[way]}", **dots(way))
        figure.add_scatter(x=rpm, y=after, name=f"predicted, {DIRECTIONS[way]}", **line(way))
    apply_look(of_amplitudes(figure, "y"), height=SMALL if small else HEIGHT)
    figure.update_xaxes(title="speed, rpm")
    figure.update_yaxes(title=f"1X at {prediction.probes[probe]}, µm 0-peak", rangemode="tozero")
    if small:
        figure.update_layout(showlegend=False, margin={"l": 40, "r": 8, "t": 4, "b": 22}, font_size=10)
        figure.update_xaxes(title=None, ticksuffix=" rpm", showticksuffix="last")
        figure.update_yaxes(title=None, ticksuffix=" µm", showticksuffix="last")
    return figure
