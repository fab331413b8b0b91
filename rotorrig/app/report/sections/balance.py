"""Balancing: what to mount, drawn on each plane; what is known of it; vectors and amplitudes before and after."""

from html import escape

import numpy as np

from rotorrig.app.report.drawings import plane_drawing
from rotorrig.app.report.figures import correction_polar, predicted
from rotorrig.app.report.html import Section, items, paragraph, plot, section, table
from rotorrig.app.text import (
    CONVENTION,
    comparison_rows,
    comparison_sentence,
    correction_rows,
    grade_sentence,
    highest_rows,
    hole_lines,
    known_sentences,
    mass_text,
    mounted_sentence,
)
from rotorrig.balancing import Balance, Prediction
from rotorrig.rig.config import RigConfig

KEY = (
    "1X in µm, 0-peak, less the slow-roll vector if there is one. Dots: as measured, filled where the speed rises and "
    "hollow where it falls; lines: as predicted with the masses on, dashed where it falls, shaded their 95 % band; the "
    "arrow: what they do to the largest vector."
)


def balance_section(balance: Balance | None, rig: RigConfig) -> Section | None:
    """Return everything of a balance; None without one."""
    if balance is None:
        return None
    return section(
        "balance",
        "Balancing",
        mounting(balance),
        planes_drawn(balance, rig),
        corrections(balance),
        items(known_sentences(balance)),
        paragraph(mounted_sentence(balance), grade_sentence(balance)),
        vibration(balance.prediction, rig),
        compared(balance),
    )


def mounting(balance: Balance) -> str:
    """Return what to mount, plane by plane."""
    masses = [mass_text(plane, complex(w)) for plane, w in zip(balance.planes, balance.mounted, strict=True)]
    return items(hole_lines(balance) or masses)


def vibration(prediction: Prediction, rig: RigConfig) -> str:
    """Return the largest amplitudes and, probe by probe, amplitudes over speed and polar plot, before and after."""
    probes = [
        f'<div class="probe">{amplitude_plot(prediction, p, share=0.57)}{polar_plot(prediction, p, rig, share=0.43)}'
        "</div>"
        for p in np.unique(prediction.probe).tolist()
    ]
    return "\n".join([highest_table(prediction), paragraph(KEY), *probes])


def highest_table(prediction: Prediction) -> str:
    """Return the largest amplitudes before and after."""
    rows = [[each.probe, each.before, each.after, each.band] for each in highest_rows(prediction)]
    header = ["probe", "before", "predicted", "95 % band there"]
    return table("Largest 1X amplitude, µm 0-peak", header, rows, amplitudes=(1, 2, 3))


def amplitude_plot(prediction: Prediction, probe: int, *, share: float, small: bool = False) -> str:
    """Return amplitude over speed at one probe; `share` is that of the paper's width, a `small` one for the sheet."""
    name = prediction.probes[probe]
    return plot(
        f"predicted-{probe}",
        predicted(prediction, probe, small=small),
        caption=f"Probe {name}",
        label=f"1X amplitude at probe {name} over speed, before and predicted. {_largest(prediction, probe)}",
        share=share,
    )


def polar_plot(prediction: Prediction, probe: int, rig: RigConfig, *, share: float, small: bool = False) -> str:
    """Return the vectors at one probe; `share` is that of the paper's width, a `small` one for the sheet."""
    name = prediction.probes[probe]
    return plot(
        f"correction-{probe}",
        correction_polar(prediction, probe, rig, small=small),
        caption=f"Probe {name}, polar",
        label=f"Polar plot of the 1X vectors at probe {name}, before and predicted. {_largest(prediction, probe)}",
        share=share,
    )


def _largest(prediction: Prediction, probe: int) -> str:
    largest = next(each for each in highest_rows(prediction) if each.probe == prediction.probes[probe])
    return f"At most {largest.before} µm 0-peak before, {largest.after} µm 0-peak predicted."


def planes_drawn(balance: Balance, rig: RigConfig) -> str:
    """Return the drawings of the planes side by side."""
    drawn = "".join(
        f"<figure><figcaption>{escape(plane)}</figcaption>{drawing}</figure>"
        for plane, drawing in ((p, plane_drawing(balance, p, rotation=rig.rotation)) for p in balance.planes)
    )
    return f'<div class="planes">{drawn}</div>'


def corrections(balance: Balance) -> str:
    """Return every correction with its interval."""
    header = ["plane", "by", "amount", "mass", "angle", "against rotation"]
    return table(f"Correction: {CONVENTION}", header, correction_rows(balance))


def compared(balance: Balance) -> str:
    """Return how a run with the masses on compares with its prediction; nothing without one."""
    if balance.comparison is None:
        return ""
    header = ["probe", "inside 95 %", "largest measured", "largest predicted"]
    after = table("The run after, µm 0-peak", header, comparison_rows(balance), amplitudes=(2, 3))
    return after + paragraph(comparison_sentence(balance))
