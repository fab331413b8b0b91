"""Tables of a lab's catalogue: of every recording the newest results, and nothing of older ones."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.dataset

from rotorrig.rig import DataError

Row = dict[str, Any]  # a column's name and its value; None where there is none

FOLDER = Path("lab", "catalogue")
_TEXT, _NUMBER, _TIME = pa.string(), pa.float64(), pa.timestamp("us", tz="UTC")
_COMMON = {"run_id": _TEXT, "key": _TEXT, "code_version": _TEXT, "made_at": _TIME}
#: the columns that are read; one that a part-file of another version has not is empty
COLUMNS: dict[str, dict[str, pa.DataType]] = {
    "runs": {
        **dict.fromkeys(("file", "rig", "config_hash", "kind", "status", "step", "sentence", "verdict"), _TEXT),
        **dict.fromkeys(("response_file", "report_file"), _TEXT),
        **dict.fromkeys(("duration_s", "lowest_speed_rpm", "highest_speed_rpm"), _NUMBER),
        **dict.fromkeys(("chi2_per_dof", "residual_um", "noise_um"), _NUMBER),
        "recorded_at": _TIME,
    },
    "estimates": {
        **dict.fromkeys(("fit", "name", "unit"), _TEXT),
        **dict.fromkeys(("value", "sigma", "low95", "high95", "nameplate"), _NUMBER),
        "determined": pa.bool_(),
    },
    "causes": {"rank": pa.int64(), "label": _TEXT, "words": _TEXT, "chosen": pa.bool_()},
    "peaks": {
        **dict.fromkeys(("run", "probe"), _TEXT),
        **dict.fromkeys(("critical_speed_rpm", "peak_um", "amplification_factor"), _NUMBER),
    },
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """The newest results of every recording, oldest recording first; the other tables by `run_id`."""

    runs: Sequence[Row]
    estimates: dict[str, list[Row]]
    causes: dict[str, list[Row]]  # in the order of their rank
    peaks: dict[str, list[Row]]


def read_catalogue(lab: Path) -> Catalogue:
    """Return the catalogue in the folder of a lab. Raises DataError if there is none, or one that cannot be read."""
    folder = lab / FOLDER
    if not any((folder / "runs").glob("*.parquet")):
        raise DataError(f"{folder}: has no table of runs, want what `rotor lab run {lab}` writes")
    newest: dict[str, Row] = {}
    for row in sorted(_read_table(folder, "runs"), key=lambda row: row["made_at"]):
        newest[row["run_id"]] = row | {"rig": row["rig"] or "unknown rig"}
    causes = _of_newest(_read_table(folder, "causes"), newest)
    return Catalogue(
        runs=sorted(newest.values(), key=lambda run: (run["recorded_at"] or run["made_at"], run["file"])),
        estimates=_of_newest(_read_table(folder, "estimates"), newest),
        causes={run: sorted(rows, key=lambda row: row["rank"]) for run, rows in causes.items()},
        peaks=_of_newest(_read_table(folder, "peaks"), newest),
    )


def _read_table(folder: Path, name: str) -> list[Row]:
    """Return the rows of all part-files of a table; none if the table is not there. Raises DataError."""
    files = sorted(str(path) for path in (folder / name).glob("*.parquet"))
    if not files:
        return []
    schema = pa.schema({**_COMMON, **COLUMNS[name]})
    try:
        rows: list[Row] = pyarrow.dataset.dataset(files, schema=schema, format="parquet").to_table().to_pylist()
    except (pa.ArrowException, OSError) as error:
        reason = str(error).partition("\n")[0].rstrip(".")
        raise DataError(f"{folder / name}: cannot be read ({reason}), make it anew with `rotor lab run`") from error
    wanted = ("run_id", "key", "made_at", *(["file"] if name == "runs" else []))
    for row in rows:
        missing = [column for column in wanted if row[column] is None]
        if missing:
            raise DataError(f"{folder / name}: has a row without {missing[0]}, make it anew with `rotor lab run`")
    return rows


def _of_newest(rows: Iterable[Row], newest: dict[str, Row]) -> dict[str, list[Row]]:
    """Return the rows that were made together with the newest results of their run, by run."""
    by_run: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        run = newest.get(row["run_id"])
        if run is not None and run["key"] == row["key"]:
            by_run[row["run_id"]].append(row)
    return dict(by_run)
