"""Causes section, with ties and the next run; pulls at the config; effects below the detection limit of this data."""

from rotorrig.app.report.html import AMPLITUDE, Section, items, paragraph, section, table
from rotorrig.app.text import (
    CAUSES_TITLE,
    NOTHING_PULLED,
    cause_evidence,
    cause_prediction_error,
    cause_size,
    cause_status,
    causes_to_list,
    finding_sentences,
    gain_sentence,
    hidden_effect_lines,
    long_name,
    next_run_sentence,
    parameter_shifts,
    pull_rows,
    tie_sentences,
)
from rotorrig.identify import Diagnosis, Identification, Verdict


def causes_section(diagnosis: Diagnosis | None) -> Section | None:
    """Return the causes tried, best first, the gain of the extended model and the next run; None if none was tried."""
    if diagnosis is None or not (parts := [part for part in (_causes_table(diagnosis), _gain(diagnosis)) if part]):
        return None
    return section("causes", "Causes", *parts)


def nameplate_section(identification: Identification | None, diagnosis: Diagnosis | None) -> Section | None:
    """Return the section, of the diagnosis if there is one; None without a fit that tells of its pulls."""
    check = diagnosis.nameplate if diagnosis else identification.fits[0].nameplate if identification else None
    if check is None or not check.pulls:
        return None
    rows = list(pull_rows(check))
    header = ["pulled most", "config", "by the data alone ± 1 σ", "pull of its group"]
    unexplained = diagnosis is not None and diagnosis.verdict is Verdict.UNEXPLAINED
    return section(
        "config",
        "The config against the data",
        items(finding_sentences(check)),
        table("Statements of the config that the fit pulls at, by group", header, rows) if rows else "",
        paragraph(_PULL_LEGEND if rows else NOTHING_PULLED, _BIASED if rows and unexplained else ""),
    )


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
    header = ["cause", "size ± 1 σ", "evidence", "χ² gained", f"error on unseen data, {AMPLITUDE}", "status"]
    chosen = [i for i, cause in enumerate(listed) if cause.chosen]
    more = len(diagnosis.causes) - len(listed)
    note = f"{more} more were tried and explain less of the residual." if more else ""
    return "".join(
        [
            table(CAUSES_TITLE, header, rows, marked=chosen, mark="chosen"),
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


_PULL_LEGEND = (
    "A pull is how far the data move what the config states, in standard deviations of what a config right within its "
    "tolerances would show. What the data hardly tell apart is judged as a group; beyond 3 σ it is a finding."
)
_BIASED = "The residual is not explained: its cause may pull at the config as well."
_LEGEND = (
    "Evidence is the gain in the Bayesian information criterion (BIC), above 0 in favour, beside what was in the model "
    "when the cause was tried: the next one of two has less left to explain. The error on unseen data is "
    "the RMS prediction error of data the fit did not use, without → with the cause. ≥: the fit was stopped early, far "
    "behind the best."
)


def _next(diagnosis: Diagnosis) -> str:
    sentence = next_run_sentence(diagnosis)
    planned = diagnosis.next_run is not None and diagnosis.next_run.planned
    return f"Next run: {sentence}" if planned else sentence
