"""Causes: what was found, what it explains and what is tied; and what this data cannot tell."""

from rotorrig.app.report.html import Section, items, paragraph, section, table
from rotorrig.app.text import causes as cause_text
from rotorrig.app.text import long
from rotorrig.identify import Diagnosis, Identification


def causes(diagnosis: Diagnosis | None) -> Section | None:
    """Return the causes tried, best first, the gain of the extended model and the next run; None if none was tried."""
    if diagnosis is None or not (parts := [part for part in (_tried(diagnosis), _gain(diagnosis)) if part]):
        return None
    return section("causes", "Causes", *parts)


def untold(identification: Identification | None, diagnosis: Diagnosis | None) -> Section | None:
    """Return what the fits and the diagnosis say this data cannot show; None if they say nothing."""
    fits = identification.fits if identification else ()
    words = [f"{fit.name}: {word}" if len(fits) > 1 else word for fit in fits for word in fit.words]
    if diagnosis is not None:
        words += [diagnosis.character] if diagnosis.character else []
        words += cause_text.untold(diagnosis)
    return section("untold", "What this data cannot tell", items(words)) if words else None


def _tried(found: Diagnosis) -> str:
    """Return the causes tried, what is tied and the run that would tell more; empty if none was tried."""
    if not found.causes:
        return ""
    listed = cause_text.listed(found)
    rows = [
        [
            cause.label,
            cause_text.size(cause),
            cause_text.evidence(cause),
            f"{'≥ ' if cause.given_up else ''}{cause.lam:.0f}",
            cause_text.heldout(cause),
            cause_text.standing(cause, found),
        ]
        for cause in listed
    ]
    header = ["cause", "size ± 1 σ", "evidence", "χ² gained", "held-out error", "standing"]
    chosen = [i for i, cause in enumerate(listed) if cause.chosen]
    more = len(found.causes) - len(listed)
    note = f"{more} more were tried and explain less." if more else ""
    return "".join(
        [
            table("Causes tried, best first", header, rows, marked=chosen, mark="chosen"),
            paragraph(_LEGEND, note),
            *map(paragraph, cause_text.ties(found)),
            paragraph(_next(found)),
        ]
    )


def _gain(found: Diagnosis) -> str:
    """Return what the extended model bought on data no fit saw; empty if nothing was measured."""
    header = ["parameter", "base model", "extended model ± 1 σ", "moved by"]
    rows = [[long(name), *rest] for name, *rest in cause_text.absorbed(found)]
    moved = table("What the base model's parameters had absorbed", header, rows) if rows else ""
    return paragraph(cause_text.gain(found)) + moved


_LEGEND = (
    "Evidence is the gain in the Bayesian information criterion, above 0 in favour; the held-out error is the root "
    "mean square misprediction of data the fit did not see, without and with the cause. ≥: its fit was given up far "
    "behind the best."
)


def _next(found: Diagnosis) -> str:
    words = cause_text.next_run(found)
    return f"The next run that would tell more: {words}" if words else ""
