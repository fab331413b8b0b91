"""The balance sheet: one page to print and take to the rig, what to mount first."""

from pathlib import Path

import numpy as np

from rotorrig.app.report.frame import write_page
from rotorrig.app.report.html import items, paragraph
from rotorrig.app.report.sections import (
    KEY,
    amplitude_plot,
    compared,
    corrections,
    highest_table,
    mounting,
    planes_drawn,
    polar_plot,
)
from rotorrig.app.text import grade_sentence, known_sentences, mounted_sentence
from rotorrig.balancing import Balance
from rotorrig.rig.config import RigConfig


def write_balance_sheet(path: Path, balance: Balance, rig: RigConfig, *, units: str = "") -> None:
    """Write the sheet of a balance, amplitudes in `units` as `write_report`.

    Raises DataError if the file cannot be written.
    """
    prediction = balance.prediction
    probes = np.unique(prediction.probe).tolist()
    polars = "".join(polar_plot(prediction, p, rig, share=1 / max(len(probes), 3), small=True) for p in probes)
    amplitudes = "".join(amplitude_plot(prediction, p, share=0.5, small=True) for p in probes)
    write_page(
        path,
        kind="Balance sheet",
        heading=rig.name,
        source=balance.source.source,
        look="sheet",
        units=units,
        body="\n".join(
            [
                f'<section class="banner" aria-labelledby="mount"><h2 id="mount">Add</h2>{mounting(balance)}</section>',
                f'<div class="facts">{planes_drawn(balance, rig)}<div>{highest_table(prediction)}</div></div>',
                corrections(balance),
                items([*known_sentences(balance), mounted_sentence(balance), grade_sentence(balance)]),
                compared(balance),
                paragraph(KEY),
                f'<div class="polars">{polars}</div>',
                f'<div class="pair">{amplitudes}</div>',
            ]
        ),
        conventions="Amplitudes are 0-peak, phases lag; angles are counted from the keyphasor mark.",
    )
