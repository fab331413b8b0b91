"""Terminal table of a query's rows, whatever its columns."""

import math
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from rich import box
from rich.table import Table

READABLE = 24  # letters of a column of text, below which it is no longer read
BETWEEN = 3  # letters between two columns


def rows_table(names: Sequence[str], rows: Sequence[Mapping[str, Any]], *, width: int) -> Table:
    """Return rows as a table: six digits of every number, a dash for null.

    Where the columns do not fit into `width` letters, every row is a block of its own, with a line for each column.
    """
    cells = [[_cell(row[name]) for name in names] for row in rows]
    needed = sum(_column_width([name, *(row[i] for row in cells)]) + BETWEEN for i, name in enumerate(names))
    if needed > width:
        return _in_blocks(names, cells)
    table = Table(box=box.SIMPLE_HEAD, caption=_number(rows), caption_justify="left")
    for name in names:
        numeric = any(isinstance(row[name], int | float) and not isinstance(row[name], bool) for row in rows)
        table.add_column(name, justify="right" if numeric else "left", overflow="fold")
    for row in cells:
        table.add_row(*row)
    return table


def _in_blocks(names: Sequence[str], cells: Sequence[Sequence[str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, show_header=False, caption=_number(cells), caption_justify="left")
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for row in cells:
        for name, cell in zip(names, row, strict=True):
            table.add_row(name, cell)
        table.add_section()
    return table


def _column_width(texts: Sequence[str]) -> int:
    """Return the letters that a column of these needs: all of a short one, some of a long text."""
    return min(max(map(len, texts)), READABLE)


def _number(rows: Sequence[Any]) -> str:
    return f"{len(rows)} row{'s' * (len(rows) != 1)}"


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, datetime):
        return f"{value:%Y-%m-%d %H:%M:%S}"
    return str(value)
