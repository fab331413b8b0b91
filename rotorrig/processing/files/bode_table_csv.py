"""A table in CSV as text cells by column, which says of every cell where it stands."""

import csv
import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import DataError


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """CSV file as text cells, with the line each row stands in."""

    path: Path
    cells: dict[str, list[str]]
    lines: list[int]

    def numbers(self, column: str) -> NDArray[np.float64]:
        """Return a column (row,); blank and "nan" are NaN. Raises DataError for other text."""
        values = np.empty(len(self.lines))
        for i, cell in enumerate(self.cells[column]):
            try:
                values[i] = float(cell) if cell else np.nan
            except ValueError as error:
                raise self.fault(i, column, f"got '{cell:.60}', want a number") from error
            if math.isinf(values[i]):
                raise self.fault(i, column, f"got '{cell:.60}', want a finite number")
        return values

    def fault(self, row: int, column: str, words: str) -> DataError:
        """Return the error of a cell: file, line, column, got, wanted."""
        return DataError(f"{self.path}: row {self.lines[row]}, column '{column}': {words}")

    def rows(self, order: NDArray[np.intp]) -> "Table":
        """Return the table with its rows in that order."""
        cells = {name: [column[i] for i in order] for name, column in self.cells.items()}
        return Table(path=self.path, cells=cells, lines=[self.lines[i] for i in order])


def read_csv(path: Path, *, delimiter: str, columns: Iterable[str]) -> Table:
    """Read a table that has each of these columns once. Raises DataError."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, delimiter=delimiter)
            rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}), want a table in CSV") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{path}: is no CSV text ({error})") from error
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    if len(rows) < 2:
        raise DataError(f"{path}: has {max(len(rows) - 1, 0)} rows below its header, want at least one")
    header = rows[0][1]
    for column in columns:
        if header.count(column) != 1:
            got = "two columns of that name" if column in header else f"the columns {header}"
            raise DataError(f"{path}: want one column '{column}', got {got}")
    for line, row in rows[1:]:
        if len(row) != len(header):
            raise DataError(f"{path}: row {line}: got {len(row)} cells, want {len(header)} as in the header")
    cells = {name: [row[i] for _, row in rows[1:]] for i, name in enumerate(header)}
    return Table(path=path, cells=cells, lines=[line for line, _ in rows[1:]])
