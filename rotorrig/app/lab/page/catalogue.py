"""Tables of a lab's catalogue: of every recording the results of one computation, and nothing of others.

It is the newest of those that went furthest: one that only tracks hides no diagnosis. One that failed since says so.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rotorrig.app.lab.storage import Lab, read_all
from rotorrig.rig import DataError

Row = dict[str, Any]  # a column's name and its value; None where there is none

STEPS = ("track", "identify", "diagnose", "report")  # further and further


@dataclass(frozen=True, slots=True, kw_only=True)
class Catalogue:
    """The results of every recording, oldest recording first; the other tables by `run_id`."""

    runs: Sequence[Row]
    estimates: dict[str, list[Row]]
    causes: dict[str, list[Row]]  # in the order of their rank
    peaks: dict[str, list[Row]]


def read_catalogue(lab: Path) -> Catalogue:
    """Return the catalogue in the folder of a lab. Raises DataError if there is none, or one that cannot be read."""
    place = Lab.of(lab)
    if not any(place.table("runs").glob("*.parquet")):
        raise DataError(f"{place.table('runs')}: has no part-files, want what `rotor lab run {lab}` writes")
    newest: dict[str, Row] = {}
    for row in sorted(_read_table(place, "runs"), key=lambda row: row["made_at"]):
        before = newest.get(row["run_id"], row)
        if row["status"] == "failed" or before["status"] == "failed" or _count_steps(row) >= _count_steps(before):
            newest[row["run_id"]] = row | {"rig": row["rig"] or "unknown rig"}
    causes = _of_newest(_read_table(place, "causes"), newest)
    return Catalogue(
        runs=sorted(newest.values(), key=lambda run: (run["recorded_at"] or run["made_at"], run["file"])),
        estimates=_of_newest(_read_table(place, "estimates"), newest),
        causes={run: sorted(rows, key=lambda row: row["rank"]) for run, rows in causes.items()},
        peaks=_of_newest(_read_table(place, "peaks"), newest),
    )


def _count_steps(run: Row) -> int:
    """Return how many steps were done."""
    return STEPS.index(run["step"]) + 1 if run["step"] in STEPS else 0


def _read_table(lab: Lab, name: str) -> list[Row]:
    """Return the rows of all part-files of a table; none if the table is not there. Raises DataError."""
    rows: list[Row] = read_all(lab, name).to_pylist()
    wanted = ("run_id", "key", "made_at", *(["file"] if name == "runs" else []))
    for row in rows:
        missing = [column for column in wanted if row[column] is None]
        if missing:
            raise DataError(f"{lab.table(name)}: has a row without {missing[0]}, make it anew with `rotor lab run`")
    return rows


def _of_newest(rows: Iterable[Row], newest: dict[str, Row]) -> dict[str, list[Row]]:
    """Return the rows that were made together with what is shown of their run, by run."""
    by_run: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        run = newest.get(row["run_id"])
        if run is not None and run["key"] == row["key"]:
            by_run[row["run_id"]].append(row)
    return dict(by_run)
