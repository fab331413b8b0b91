"""Rows of the response: runs (up, down, dwell) of a recording, rows of revolutions within them, quality and masks."""

from rotorrig.processing.rows.rows import Rows, crowded_share, lay_rows
from rotorrig.processing.rows.runs import ENDS, Span, find_runs

__all__ = [
    "ENDS",
    "Rows",
    "Span",
    "crowded_share",
    "find_runs",
    "lay_rows",
]
