"""What a lab keeps, and where: part-files of the catalogue in `lab/catalogue`, files of its runs in `lab/results`.

A part-file is Parquet, one a table and computation, written whole by one process: several writers never meet.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.dataset as ds
import pyarrow.parquet as pq

from rotorrig.app.lab.schema import TABLES
from rotorrig.rig import DataError, write_whole_file

FOLDER = "lab"
Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Lab:
    """Folder of a lab: the recordings' tree, and in it `lab` with what came of them."""

    root: Path

    @classmethod
    def of(cls, folder: str | Path) -> "Lab":
        """Return the lab of an existing folder, by its absolute path. Raises DataError if it is none."""
        folder = Path(folder)
        if not folder.is_dir():
            raise DataError(f"{folder}: is no folder, want the one that the recordings are in")
        return cls(folder.resolve())

    def table(self, name: str) -> Path:
        """Return the folder of a table's part-files."""
        return self.root / FOLDER / "catalogue" / name

    def part(self, table: str, run_id: str, key: str) -> Path:
        """Return the part-file of a computation in a table."""
        return self.table(table) / f"{run_id}-{key}.parquet"

    def results(self, run_id: str, key: str) -> Path:
        """Return the folder of a computation's files."""
        return self.root / FOLDER / "results" / run_id / key

    def curves(self, run_id: str, key: str) -> Path:
        """Return the script with the 1X curves of a computation's response, for pages."""
        return self.results(run_id, key) / "curves.js"

    def relative(self, path: Path) -> str:
        """Return a path below the lab's folder as the catalogue has it, with "/"."""
        return path.relative_to(self.root).as_posix()

    def make_folders(self) -> None:
        """Make the folders of the catalogue. Raises DataError if that is not possible."""
        try:
            for name in TABLES:
                self.table(name).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DataError(f"{self.root / FOLDER}: cannot be written ({error.strerror})") from error


def write_parts(lab: Lab, run_id: str, key: str, rows: Mapping[str, Sequence[Row]]) -> None:
    """Write the rows of a computation, `runs` last: with it the computation is done. Raises DataError."""
    for table in sorted(TABLES, key=lambda name: name == "runs"):
        made = pa.Table.from_pylist([dict(row) for row in rows[table]], schema=TABLES[table])
        with write_whole_file(lab.part(table, run_id, key)) as file:
            pq.write_table(made, file, compression="zstd")


def read_part(lab: Lab, table: str, run_id: str, key: str) -> list[dict[str, Any]]:
    """Return the rows of a computation in a table; none if it was not made. Raises DataError if it is damaged."""
    path = lab.part(table, run_id, key)
    return _read([path], TABLES[table]).to_pylist() if path.exists() else []


def read_all(lab: Lab, table: str) -> pa.Table:
    """Return the rows of all computations in a table, of every code version. Raises DataError for a damaged file.

    A column that a part-file lacks is null, one that is not in the schema left out.
    """
    return _read(sorted(lab.table(table).glob("*.parquet")), TABLES[table])


def _read(paths: Sequence[Path], schema: pa.Schema) -> pa.Table:
    lenient = pa.schema([field.with_nullable(True) for field in schema])  # an older part-file may lack a column
    if not paths:
        return lenient.empty_table()
    try:
        return ds.dataset([str(path) for path in paths], schema=lenient, format="parquet").to_table()
    except (pa.ArrowException, OSError) as error:
        damaged = next((path for path in paths if not _is_whole(path)), paths[0])
        raise DataError(
            f"{damaged}: is no part-file of a catalogue, or damaged; delete it and run the lab again"
        ) from error


def _is_whole(path: Path) -> bool:
    try:
        pq.read_table(path)
    except (pa.ArrowException, OSError):
        return False
    return True
