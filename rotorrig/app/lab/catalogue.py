"""Questions to a catalogue in SQL, answered by DuckDB: its tables in memory, and no way to any other file."""

from pathlib import Path
from typing import TYPE_CHECKING

import duckdb
import pyarrow as pa

from rotorrig.app.lab.schema import TABLES
from rotorrig.app.lab.storage import Lab, read_all
from rotorrig.rig import DataError

if TYPE_CHECKING:
    import pandas as pd

#: of every recording the rows of the computation that last made any: a later one that only tracks hides no estimates
LATEST = """create view {table} as select * from {table}_all
    where (run_id, key) in (select (run_id, arg_max(key, made_at)) from {table}_all group by run_id)"""
#: what SQL may not do from here on: read or write files, load extensions, see Python's variables, undo this
LOCKS = (
    "set python_enable_replacements = false",
    "set autoinstall_known_extensions = false",
    "set enable_external_access = false",
    "set lock_configuration = true",
)


def open_catalogue(folder: str | Path) -> duckdb.DuckDBPyConnection:
    """Return a connection to the catalogue of a lab's folder, as it is now: a copy in memory, which SQL cannot leave.

    The tables are those of docs/lab.md; `<table>_all` has the rows of every computation, `<table>` those of the newest
    of each recording. Raises DataError if there is no catalogue or a part-file is damaged.
    """
    lab = Lab.of(folder)
    if not lab.table("runs").is_dir():
        raise DataError(f"{folder}: has no catalogue, want a folder that `rotor lab run` has worked through")
    connection = duckdb.connect(":memory:")
    connection.execute("set TimeZone = 'UTC'")
    for table in TABLES:
        connection.register("part_files", read_all(lab, table))
        connection.execute(f"create table {table}_all as select * from part_files")
        connection.unregister("part_files")
        connection.execute(LATEST.format(table=table))
    for lock in LOCKS:
        connection.execute(lock)
    return connection


def query_table(folder: str | Path, sql: str) -> pa.Table:
    """Return what one SELECT on the catalogue of a lab's folder yields, as an Arrow table. Raises DataError."""
    with open_catalogue(folder) as connection:
        try:
            statements = connection.extract_statements(sql)
            if len(statements) != 1 or statements[0].type != duckdb.StatementType.SELECT:
                raise DataError(f"got {_shorten(sql)!r}, want one SELECT; the tables are {', '.join(TABLES)}")
            table: pa.Table = connection.sql(sql).to_arrow_table()
            return table.rename_columns(_tell_apart(table.column_names))
        except (duckdb.Error, pa.ArrowException) as error:
            raise DataError(f"query: {_first_line(error)}") from error


def query(folder: str | Path, sql: str) -> "pd.DataFrame":
    """Return what one SELECT on the catalogue of a lab's folder yields, as a DataFrame. Raises DataError.

    `query("recordings", "select file, verdict from runs where status = 'done'")`
    """
    return query_table(folder, sql).to_pandas()


def _tell_apart(names: list[str]) -> list[str]:
    """Return names of columns with a number behind those that stood before.

    >>> _tell_apart(["file", "verdict", "file"])
    ['file', 'verdict', 'file_2']
    """
    return [name if (n := names[: i + 1].count(name)) == 1 else f"{name}_{n}" for i, name in enumerate(names)]


def _shorten(sql: str) -> str:
    words = " ".join(sql.split())
    return words if len(words) <= 60 else f"{words[:57]}..."


def _first_line(error: Exception) -> str:
    """Return DuckDB's complaint without its drawing of the place, and with what it proposes instead."""
    lines = [line.strip() for line in str(error).splitlines()]
    told = [line for line in lines if line and not line.startswith(("LINE ", "^"))]
    return " ".join(told)
