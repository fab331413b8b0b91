"""Which revolutions make a row of the response: runs up, down and held, rows within them, quality and masks."""

from rotorrig.processing.rows.rows import Rows, lay_rows, too_close
from rotorrig.processing.rows.runs import ENDS, Span, find_runs

__all__ = [
    "ENDS",
    "Rows",
    "Span",
    "find_runs",
    "lay_rows",
    "too_close",
]
