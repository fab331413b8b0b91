"""Causes section, with ties and the next run; effects below the detection limit of this data."""

from rotorrig.app.report.html import Section, items, paragraph, section, table
from rotorrig.app.text import (
    cause_evidence,
    cause_prediction_error,
    cause_size,
    cause_status,
    causes_to_list,
    gain_sentence,
    hidden_effect_lines,
    long_name,
    next_run_sentence,
    parameter_shifts,
    tie_sentences,
)
from rotorrig.identify import Diagnosis, Identification


def causes_section(diagnosis: Diagnosis | None) -> Section | None:
    """Return the causes tried, best first, the gain of the extended model and the next run; None if none was tried."""
    if diagnosis is None or not (parts := [part for part in (_causes_table(diagnosis), _gain(diagnosis)) if part]):
        return None
    return section("causes", "Causes", *parts)


def undetectable_section(identification: Identification | None, diagnosis: Diagnosis | None) -> Section | None:
    """Return the parameters and effects this data does not determine; None if there are none."""
    fits = identification.fits if identification else ()
    lines = [f"{fit.name}: {words}" if len(fits) > 1 else words for fit in fits for words in fit.words]
    if diagnosis is not None:
        lines += [diagnosis.character] if diagnosis.character else []
        lines += hidden_effect_lines(diagnosis)
    return section("untold", "What this data cannot show", items(lines)) if lines else None


def _causes_table(diagnosis: Diagnosis) -> str:
    """Return the table of causes, the ties and the proposed next run; empty if none was tried."""
    if not diagnosis.causes:
        return ""
    listed = causes_to_list(diagnosis)
    rows = [
        [
            cause.label,
            cause_size(cause),
            cause_evidence(cause),
            f"{'≥ ' if cause.given_up else ''}{cause.lam:.0f}",
            cause_prediction_error(cause),
            cause_status(cause, diagnosis),
        ]
        for cause in listed
    ]
    header = ["cause", "size ± 1 σ", "evidence", "χ² gained", "error on unseen data", "status"]
    chosen = [i for i, cause in enumerate(listed) if cause.chosen]
    more = len(diagnosis.causes) - len(listed)
    note = f"{more} more were tried and explain less of the residual." if more else ""
    return "".join(
        [
            table("Causes tried, best first", header, rows, marked=chosen, mark="chosen"),
            paragraph(_LEGEND, note),
            *map(paragraph, tie_sentences(diagnosis)),
            paragraph(_next(diagnosis)),
        ]
    )


def _gain(diagnosis: Diagnosis) -> str:
    """Return the cross-validation error and the shifts of the base parameters; empty if nothing was measured."""
    header = ["parameter", "base model", "extended model ± 1 σ", "shift"]
    rows = [[long_name(name), *rest] for name, *rest in parameter_shifts(diagnosis)]
    shifts = table("Bias of the base model's parameters from the missing effect", header, rows) if rows else ""
    return paragraph(gain_sentence(diagnosis)) + shifts


_LEGEND = (
    "Evidence is the gain in the Bayesian information criterion (BIC), above 0 in favour. The error on unseen data is "
    "the RMS prediction error of data the fit did not use, without → with the cause. ≥: the fit was stopped early, far "
    "behind the best."
)


def _next(diagnosis: Diagnosis) -> str:
    sentence = next_run_sentence(diagnosis)
    planned = diagnosis.next_run is not None and diagnosis.next_run.planned
    return f"Next run: {sentence}" if planned else sentence
