"""What is seen first, below the verdict: the loudest probe's Bode and polar plot, the rig, the identified values."""

import numpy as np

from rotorrig.app.plot_data import cause_places, choose_resonances, critical_speeds, predictions, vectors
from rotorrig.app.report.drawings import side_view
from rotorrig.app.report.figures import bode, polar
from rotorrig.app.report.html import Section, paragraph, plot, scrolling, table
from rotorrig.app.text import cause_name, critical_words, estimate_text, parameter_shifts, quantity_text
from rotorrig.identify import Diagnosis, Identification, Verdict
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig

FOUND = (Verdict.NAMED, Verdict.TIED, Verdict.DESCRIBED)
HEIGHT = 330  # px, of the plots: with verdict, drawing and values they fill a screen


def first_screen(
    response: OrderTrackedResponse, identification: Identification | None, diagnosis: Diagnosis | None
) -> Section:
    """Return the section; `diagnosis` is the part for `response`."""
    plots, values = _plots(response, identification, diagnosis), _values(identification, diagnosis)
    rig = f'<figure class="wide">{scrolling("The rig", _drawing(response.rig, diagnosis))}</figure>'
    html = (
        '<section id="glance" aria-labelledby="h-glance"><h2 id="h-glance" class="heard">At a glance</h2>'
        f'<div class="probe">{plots}</div><div class="facing">{rig}<div>{values}</div></div></section>'
    )
    return Section("glance", "At a glance", html)


def _plots(response: OrderTrackedResponse, identification: Identification | None, diagnosis: Diagnosis | None) -> str:
    """Return Bode and polar plot of the probe with the largest 1X vector."""
    fit = identification.fits[0] if identification and identification.fits else None
    base, extended = predictions(response, fit, diagnosis)
    size = np.where(response.usable & np.isfinite(vectors(response)), np.abs(vectors(response)), -1.0)
    probe = int(np.argmax(size.max(axis=0, initial=-1.0)))
    name = response.probes[probe]
    best = base if extended is None else extended
    found = [each for each in critical_speeds(response, best, choose_resonances(fit, diagnosis)) if each.probe == name]
    before = None if extended is None else base
    words = " ".join(critical_words(each.run, each.measured) for each in found)
    left = plot(
        "first-bode",
        bode(response, probe, prediction=best, before=before, resonances=found, height=HEIGHT),
        caption=f"Probe {name}, the loudest, 1X: measured (dots)" + (" and model (lines)" if best is not None else ""),
        label=f"Bode plot of probe {name}. {words} Its values are in the section on the synchronous response.",
        share=1.0 if response.amplitudes_alone else 0.57,
    )
    if response.amplitudes_alone:
        return left
    right = plot(
        "first-polar",
        polar(response, probe, prediction=best, before=before, height=HEIGHT),
        caption=f"Probe {name}, polar",
        label=f"Polar plot of probe {name}, 1X vectors over speed.",
        share=0.43,
    )
    return left + right


def _drawing(rig: RigConfig, diagnosis: Diagnosis | None) -> str:
    """Return the side view, with the places of what was found; what was tried in vain is not pointed at."""
    if diagnosis is None or diagnosis.verdict not in FOUND:
        return side_view(rig)
    missing = diagnosis.missing
    likely = (missing.places, missing.probability) if missing and missing.is_described and missing.places.size else None
    chosen = [cause for cause in diagnosis.causes if cause.chosen]
    marked = [(place, cause_name(cause)) for cause in chosen for place in cause_places(cause, rig)]
    return side_view(rig, likely=likely, marked=marked)


def _values(identification: Identification | None, diagnosis: Diagnosis | None) -> str:
    """Return the identified values beside the nameplate: of the extended model, where that explains the run."""
    if identification is None or not identification.fits:
        return paragraph("rotor identify fits bearings and unbalance to this run.")
    fit = identification.fits[0]
    found = diagnosis is not None and diagnosis.verdict in FOUND
    extended = {name: after for name, _, after, _ in parameter_shifts(diagnosis)} if diagnosis and found else {}
    describes = diagnosis.verdict in (Verdict.ADEQUATE, Verdict.CANNOT_TELL) if diagnosis else fit.adequate
    model = "by a model that does NOT describe the run" if not describes else "± 1 σ"
    rows = [
        [each.name, extended.get(each.name) or estimate_text(each), quantity_text(each.nameplate, each.unit)]
        for each in fit.estimates
    ]
    return table(
        f"Identified, {'with what was found in the model' if extended else model}",
        ["", "identified", "nameplate"],
        rows,
    )
