"""Section of an investigation: the runs that were made, why each was chosen, and what was believed after it."""

from rotorrig.app.report.html import Section, items, paragraph, section
from rotorrig.app.text import belief_text, run_text
from rotorrig.investigation import Journal, Round


def investigation_section(journal: Journal | None) -> Section | None:
    """Return the rounds as a list; None without an investigation."""
    if journal is None:
        return None
    return section(
        "investigation",
        "How it was found",
        paragraph("Runs in their order, each judged together with those before it; probabilities of the causes known."),
        items(_describe_round(each) for each in journal.judged),
        paragraph(journal.ending),
    )


def _describe_round(made: Round) -> str:
    return f"Run {run_text(made)}. {made.why} After it: {made.verdict}; {belief_text(made.beliefs)}."
