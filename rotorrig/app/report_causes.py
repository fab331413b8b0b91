"""The report's sections on causes: what was found, what it explains, what is tied, and what this data cannot show."""

from html import escape

from rotorrig.app import cause_words
from rotorrig.app.report_tables import table
from rotorrig.identify.diagnosis import Diagnosis


def causes(found: Diagnosis) -> str:
    """Return the causes tried, best first, and the gain of the extended model; empty if none was tried."""
    if not found.causes:
        return ""
    listed = cause_words.listed(found)
    rows = [
        [
            cause.label,
            cause_words.size(cause),
            cause_words.evidence(cause),
            f"{'≥ ' if cause.given_up else ''}{cause.lam:.0f}",
            cause_words.heldout(cause),
            cause_words.standing(cause, found),
        ]
        for cause in listed
    ]
    header = ["cause", "size ± 1 σ", "evidence", "χ² gained", "held-out error", "standing"]
    chosen = [i for i, cause in enumerate(listed) if cause.chosen]
    more = len(found.causes) - len(listed)
    note = f" {more} more were tried and explain less." if more else ""
    return "\n".join(
        [
            table("Causes tried, best first", header, rows, marked=chosen, mark="chosen"),
            f"<p>{escape(_LEGEND + note)}</p>",
            *(f"<p>{escape(words)}</p>" for words in (*cause_words.ties(found), _next(found)) if words),
        ]
    )


def gain(found: Diagnosis) -> str:
    """Return what the extended model bought on data no fit saw; empty if nothing was measured."""
    said = cause_words.gain(found)
    rows = [list(row) for row in cause_words.absorbed(found)]
    parts = [f"<p>{escape(said)}</p>"] if said else []
    if rows:
        header = ["parameter", "base model", "extended model", "moved by"]
        parts.append(table("What the base model's parameters had absorbed", header, rows))
    return "\n".join(parts)


def untold(found: Diagnosis) -> list[str]:
    """Return the sentences on what this data cannot show."""
    return [*([found.character] if found.character else []), *cause_words.untold(found)]


_LEGEND = (
    "Evidence is the gain in the Bayesian information criterion, above 0 in favour; the held-out error is the root "
    "mean square misprediction of data the fit did not see, without and with the cause. ≥: its fit was given up far "
    "behind the best."
)


def _next(found: Diagnosis) -> str:
    words = cause_words.next_run(found)
    return f"The next run that would tell more: {words}" if words else ""
