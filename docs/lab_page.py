"""Parts of docs/lab.md: the catalogue's tables from the schema in rotorrig/app/lab, and what its benchmark kept."""

import json
from pathlib import Path
from typing import Any

import pyarrow as pa

from rotorrig.app.lab import TABLES

BEGIN, END = "<!-- tables of the catalogue: written by `make docs` -->", "<!-- end of the tables -->"
BEGIN_FIGURES, END_FIGURES = "<!-- figures: written by `make docs` -->", "<!-- end of the figures -->"
KEPT = Path(__file__).parents[1] / "benchmarks/parts/lab/results.jsonl"
IDLE = 0.5  # programs at work, on average: with more, times are not those of the program
SHARED = 4  # columns that every table begins with, shown once
TYPES = {pa.string(): "text", pa.float64(): "double", pa.int64(): "bigint", pa.bool_(): "boolean"}


def shown(text: str) -> str:
    """Return the text of lab.md with tables and figures between their marks made anew."""
    return _between(_between(text, BEGIN, END, tables()), BEGIN_FIGURES, END_FIGURES, figures())


def figures() -> str:
    """Return what the benchmark kept last, in Markdown, without times where other programs were at work."""
    kept: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8").splitlines()[-1])
    if kept["load_before"] > IDLE:
        kept |= dict.fromkeys(("efficiency", "overhead_ms", "seconds_again"), "not measured")
    rows = [
        ("recordings", kept["recordings"]),
        ("diagnosed too", kept["diagnosed"]),
        ("programs at work before it began, on average", kept["load_before"]),
        ("time of two plain processes / time of `rotor lab run --workers 2`", kept["efficiency"]),
        ("rows and files that differ between the two", kept["differences"]),
        ("a task that does nothing, of a worker's time, ms", kept["overhead_ms"]),
        ("the same, of the processor's time of command and scheduler, ms", kept.get("overhead_cpu_ms", "not measured")),
        ("the same command again, with nothing to do, s", kept["seconds_again"]),
        ("memory of the larger worker after a tenth of the recordings", f"{kept['memory_tenth_mib']} MiB"),
        ("at the end", f"{kept['memory_end_mib']} MiB"),
        ("done before the command was killed, and a worker before it", kept["killed_before"]),
        ("of those done again by the next command", kept["resumed_twice"]),
        ("processes left after the command was killed", kept["orphans"]),
        ("recordings without a row in the end", kept["missing"]),
    ]
    return "\n".join([f"| {kept['date']} | |", "|---|---:|", *(f"| {what} | {value} |" for what, value in rows)])


def _between(text: str, begin: str, end: str, part: str) -> str:
    before, rest = text.split(begin)
    return f"{before}{begin}\n\n{part}\n\n{end}{rest.split(end)[1]}"


def tables() -> str:
    """Return the tables of the catalogue in Markdown, a row a column."""
    parts = []
    for name, schema in TABLES.items():
        rows = [_row(field) for field in (schema if name == "runs" else list(schema)[SHARED:])]
        parts.append("\n".join([f"### {name}", "", "| column | type | unit | meaning |", "|---|---|---|---|", *rows]))
    return "\n\n".join(parts)


def _row(field: pa.Field) -> str:
    told = {name.decode(): value.decode() for name, value in field.metadata.items()}
    kind = TYPES.get(field.type, "timestamp") + (", may be null" if field.nullable else "")
    return f"| `{field.name}` | {kind} | {told['unit']} | {told['description']} |"
