"""Rows of a query as files and as JSON: CSV and Parquet that say which question they answer."""

import math
from collections.abc import Iterator
from datetime import date, datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq

from rotorrig.acquisition.files import LAB_CSV, LAB_PARQUET
from rotorrig.rig import DataError, write_whole_file


def write_csv(path: Path, table: pa.Table, *, sql: str) -> None:
    """Write rows as CSV behind a comment with the query. Raises DataError."""
    try:
        with write_whole_file(path) as file:
            file.write(LAB_CSV + f" {' '.join(sql.split())}\n".encode())
            pyarrow.csv.write_csv(table, file)
    except pa.ArrowException as error:
        raise DataError(f"{path}: cannot hold these columns ({error}), want --parquet") from error


def write_parquet(path: Path, table: pa.Table, *, sql: str) -> None:
    """Write rows as Parquet, with the query in its metadata. Raises DataError."""
    with write_whole_file(path) as file:
        pq.write_table(table.replace_schema_metadata({LAB_PARQUET: sql.encode()}), file, compression="zstd")


def json_rows(table: pa.Table) -> Iterator[dict[str, Any]]:
    """Yield rows as strict JSON holds them: times as text in UTC, null for what is not finite."""
    for row in table.to_pylist():
        yield {name: _plain(value) for name, value in row.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, datetime | date):
        return value.isoformat()
    return value if isinstance(value, str | int | bool | None) else str(value)
