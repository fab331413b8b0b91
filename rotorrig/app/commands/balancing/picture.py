"""The picture of a prediction: one self-contained HTML page, amplitude over speed at every probe."""

from html import escape
from pathlib import Path

import numpy as np
from plotly.io import to_html

from rotorrig.app.report.figures import predicted
from rotorrig.balancing import Prediction
from rotorrig.rig import write_whole_text

CAPTION = (
    "1X amplitude in µm, 0-peak, less the slow-roll vector if there is one: dots as measured, lines as predicted with "
    "the masses on, shaded their 95 % band. Angles are from the keyphasor mark in the sense of rotation."
)


def write_picture(path: Path, prediction: Prediction, *, rig: str, masses: str) -> None:
    """Write the page. Raises DataError if it cannot be written."""
    plots: list[str] = []
    for probe in np.unique(prediction.probe):
        library: bool | str = "inline" if not plots else False
        figure = predicted(prediction, int(probe))
        plots.append(str(to_html(figure, full_html=False, include_plotlyjs=library, config={"displaylogo": False})))
    page = (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(rig)}: predicted vibration</title></head>\n"
        f'<body style="font-family: system-ui, sans-serif; max-width: 60rem; margin: auto">'
        f"<h1>{escape(rig)}: predicted vibration</h1><p>With {escape(masses)}.</p><p>{CAPTION}</p>\n"
        + "\n".join(plots)
        + "\n</body></html>\n"
    )
    write_whole_text(path, page)
