"""Cases that are done, one JSON line each, and the attempts they belong to.

A line is written whole as soon as its case is done: a kill loses the case under way, and what it leaves of a line is
not read and is cut off by the next run. An attempt is one version of the code, the digest of its sources, on seeds of
its own; a line of another version is not counted. When the code has changed, the attempt is superseded, by a sentence
that says why, and the next one takes new seeds; what was found until then stays in attempts.jsonl.
"""

import fcntl
import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks.parts.blind.cases import EXAMINATION
from rotorrig.rig import ConfigError

ROOT = Path(__file__).parents[3]
FOLDER = Path(__file__).parent / "results"
LATER = frozenset({"app", "balancing", "investigation"})  # stages after the diagnosis: no case runs them
PAGE_ALONE = {"score.py", "page.py", "records.py"}  # judge and print what is kept, and make no case

Record = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One examination: one version, its seeds, and what became of it."""

    number: int
    begun: str  # date, UTC
    version: str
    first_seed: int
    superseded: str = ""  # why; "": it stands
    until: str = ""  # date of that
    verdicts: dict[str, int] = field(default_factory=dict)  # counts at that time


@cache
def source_version(*, later: frozenset[str] = LATER) -> str:
    """Return the digest of all that a case depends on: `later` stages of the program are not among it.

    That is the program up to the diagnosis, the RK4's config, and what draws and runs cases.
    """
    found = hashlib.sha256()
    stages = [stage for stage in (ROOT / "rotorrig").iterdir() if stage.is_dir() and stage.name not in later]
    program = [path for kind in ("*.py", "*.toml") for stage in stages for path in stage.rglob(kind)]
    harness = [path for path in (ROOT / "benchmarks/parts/blind").rglob("*.py") if path.name not in PAGE_ALONE]
    for path in sorted([*program, *harness, ROOT / "configs/rk4.toml"]):
        found.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:12]


def results_file(attempt: Attempt, folder: Path = FOLDER) -> Path:
    """Return the file of an attempt's cases."""
    return folder / f"attempt-{attempt.number}.jsonl"


def read_records(path: Path, *, version: str) -> dict[str, Record]:
    """Return the cases of that version by design and name, the newest line of each."""
    return {_key(record): record for record in _lines(path) if record["version"] == version}


def read_newest(path: Path) -> list[Record]:
    """Return the newest line of every case by its name, of whatever version."""
    return list({record["name"]: record for record in _lines(path)}.values())


@contextmanager
def open_records(path: Path) -> Iterator[int]:
    """Open a file of cases to append to, alone; yield its descriptor. Raises ConfigError if another run has it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
    try:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ConfigError(f"{path}: another run is writing into it, want one at a time") from error
        whole = path.read_bytes().rpartition(b"\n")
        os.ftruncate(file, len(whole[0]) + len(whole[1]))
        yield file
    finally:
        os.close(file)


def append_record(file: int, record: Mapping[str, Any]) -> None:
    """Append one line, on the disk when this returns."""
    os.write(file, json.dumps(record).encode() + b"\n")
    os.fsync(file)


def attempts(folder: Path = FOLDER) -> list[Attempt]:
    """Return all attempts, oldest first."""
    return [Attempt(**line) for line in _lines(folder / "attempts.jsonl")]


def standing_attempt(folder: Path = FOLDER) -> Attempt | None:
    """Return the attempt that is not superseded, if one was begun."""
    return next((each for each in attempts(folder) if not each.superseded), None)


def choose_attempt(folder: Path = FOLDER) -> Attempt | None:
    """Return the attempt whose figures are told: the one that stands, else the newest of which cases are kept."""
    with_cases = [each for each in attempts(folder) if results_file(each, folder).exists()]
    return standing_attempt(folder) or (with_cases[-1] if with_cases else None)


def begin_attempt(folder: Path = FOLDER) -> Attempt:
    """Return the standing attempt, or begin the next. Raises ConfigError if it is of another version of the code."""
    version = source_version()
    if (standing := standing_attempt(folder)) is not None:
        if standing.version != version:
            raise ConfigError(
                f"attempt {standing.number}: is of version {standing.version} and the code here of {version}; "
                "go back to that one, or --supersede the attempt, with a reason"
            )
        return standing
    number = len(attempts(folder))
    begun = Attempt(number=number, begun=_today(), version=version, first_seed=EXAMINATION * number)
    _write_attempts([*attempts(folder), begun], folder)
    return begun


def supersede_attempt(why: str, folder: Path = FOLDER) -> None:
    """End the standing attempt: it stays on the page with its counts. Raises ConfigError if there is none."""
    if (standing := standing_attempt(folder)) is None:
        raise ConfigError("--supersede: no attempt stands, want one that was begun")
    records = read_records(results_file(standing, folder), version=standing.version)
    ended = replace(standing, superseded=why, until=_today(), verdicts=count_verdicts(list(records.values())))
    _write_attempts([ended if each == standing else each for each in attempts(folder)], folder)


def count_verdicts(records: Sequence[Record]) -> dict[str, int]:
    """Return how often every verdict was given."""
    return dict(sorted(Counter(record["verdict"] for record in records).items()))


def _write_attempts(listed: Sequence[Attempt], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / "attempts.part"
    part.write_text("".join(json.dumps(asdict(each)) + "\n" for each in listed), encoding="utf-8")
    part.replace(folder / "attempts.jsonl")


def _lines(path: Path) -> list[Record]:
    """Return the whole lines of a file; what follows the last end of line was cut off by a kill."""
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return [json.loads(line) for line in text.rpartition("\n")[0].splitlines()]


def _key(record: Record) -> str:
    return f"{record['design']} {record['name']}"


def _today() -> str:
    return f"{datetime.now(UTC):%Y-%m-%d}"
