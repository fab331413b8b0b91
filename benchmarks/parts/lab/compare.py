"""Whether two labs of the same recordings have the same results, to the last bit."""

import json
from pathlib import Path
from typing import Any

from rotorrig.app.lab import TABLES, query_table

TIMES = {"made_at", "recorded_at", "seconds_track", "seconds_identify", "seconds_diagnose"}


def count_differences(one: Path, other: Path) -> int:
    """Return how many rows and result files of two labs differ, but for when they were made and how long that took."""
    rows = sum(_differing_rows(one, other, table) for table in TABLES)
    files = {path.relative_to(folder) for folder in (one, other) for path in folder.glob("lab/results/*/*/*.*")}
    return rows + sum(_content(one / path) != _content(other / path) for path in files)


def _differing_rows(one: Path, other: Path, table: str) -> int:
    kept = [
        [
            {name: value for name, value in row.items() if name not in TIMES}
            for row in query_table(folder, f"select * from {table} order by all").to_pylist()
        ]
        for folder in (one, other)
    ]
    return abs(len(kept[0]) - len(kept[1])) + sum(a != b for a, b in zip(*kept, strict=False))


def _content(path: Path) -> Any:
    if not path.is_file():
        return None
    if path.suffix == ".json":
        return json.loads(path.read_bytes()) | {"wall_s": None}
    return path.read_bytes()
