"""Section of an investigation: the runs that were made, why each was chosen, and what was believed after it."""

from rotorrig.app.report.html import Section, paragraph, section, table
from rotorrig.app.text import belief_text, run_text
from rotorrig.investigation import Journal

HEADER = ("run", "why it was made", "verdict after it", "probability of the causes")


def investigation_section(journal: Journal | None) -> Section | None:
    """Return the rounds as a table; None without an investigation."""
    if journal is None:
        return None
    rows = [(run_text(each), each.why, str(each.verdict), belief_text(each.beliefs)) for each in journal.judged]
    return section(
        "investigation",
        "How it was found",
        table("Runs in their order, each judged together with those before it", HEADER, rows),
        paragraph(journal.ending),
    )
