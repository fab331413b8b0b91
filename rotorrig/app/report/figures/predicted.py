"""Amplitude over speed at one probe, before and as predicted with masses on, with the 95 % band."""

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.report.figures.look import COLOURS, SHEER, apply_look, dots, line
from rotorrig.balancing import Prediction
from rotorrig.rig.config import RPM, UM

HEIGHT = 320  # px
NAMES = {1: "up", -1: "down", 0: "dwell"}


def predicted(prediction: Prediction, probe: int) -> go.Figure:
    """Return the figure of one probe: dots as measured, a line and its band as predicted."""
    figure = go.Figure()
    low, high = prediction.band
    for way in (1, -1, 0):
        rows = np.flatnonzero((prediction.probe == probe) & (prediction.direction == way))
        rows = rows[np.argsort(prediction.omega[rows])]
        if not rows.size:
            continue
        rpm = np.round(prediction.omega[rows] * RPM, 1)
        figure.add_scatter(
            x=np.concatenate([rpm, rpm[::-1]]),
            y=np.round(np.concatenate([high[rows], low[rows][::-1]]) * UM, 3),
            fill="toself",
            fillcolor=SHEER[way].replace("0.65", "0.2").replace("0.75", "0.2").replace("0.6)", "0.2)"),
            line={"width": 0, "color": COLOURS[way]},
            name=f"95 %, {NAMES[way]}",
            hoverinfo="skip",
        )
        before, after = (np.round(np.abs(z[rows]) * UM, 3) for z in (prediction.before, prediction.after))
        figure.add_scatter(x=rpm, y=before, name=f"before, {NAMES[way]}", **dots(way))
        figure.add_scatter(x=rpm, y=after, name=f"predicted, {NAMES[way]}", **line(way))
    apply_look(figure, height=HEIGHT)
    figure.update_xaxes(title="speed, rpm")
    figure.update_yaxes(title=f"1X at {prediction.probes[probe]}, µm 0-peak", rangemode="tozero")
    return figure
