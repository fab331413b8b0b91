"""Kept cases outlive a kill; an attempt is one version on seeds of its own; what was superseded stays."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmarks.parts.blind import records
from benchmarks.parts.blind.records import (
    append_record,
    attempts,
    begin_attempt,
    choose_attempt,
    open_records,
    read_records,
    results_file,
    source_version,
    standing_attempt,
    supersede_attempt,
)
from rotorrig.rig import ConfigError

ROOT = Path(__file__).parents[4]
RUN = """
import sys, time
from pathlib import Path
from typing import Any
from benchmarks.parts.jobs import run_limited
from benchmarks.parts.blind.records import append_record, open_records, read_records

path, names = Path(sys.argv[1]), [f"case-{i}" for i in range(int(sys.argv[2]))]


def work(name):
    time.sleep(0.3)
    yield {"design": "P2", "name": name, "version": "v", "verdict": "adequate", "filler": "x" * 20000}


if __name__ == "__main__":
    with open_records(path) as file:
        kept = read_records(path, version="v")
        left = [name for name in names if f"P2 {name}" not in kept]
        print("left", len(left), flush=True)
        run_limited(work, left, workers=2, limit=60, done=lambda name, parts, ending: append_record(file, parts))
"""


def run(tmp_path: Path, count: int) -> subprocess.Popen[str]:
    """Start a program that runs what is not kept of so many cases."""
    program = tmp_path / "program.py"
    program.write_text(RUN)
    arguments = [sys.executable, str(program), str(tmp_path / "kept.jsonl"), str(count)]
    return subprocess.Popen(arguments, env=os.environ | {"PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, text=True)


def test_a_run_that_is_killed_goes_on_where_it_was(tmp_path: Path) -> None:
    path = tmp_path / "kept.jsonl"
    with run(tmp_path, 6) as first:
        deadline = time.monotonic() + 60
        while not (path.exists() and path.read_bytes().count(b"\n") >= 2):
            assert time.monotonic() < deadline
            time.sleep(0.02)
        os.kill(first.pid, signal.SIGKILL)
    with path.open("ab") as file:
        file.write(b'{"design": "P2", "name": "torn')  # as a kill in the middle of a write leaves it
    before = read_records(path, version="v")
    assert 2 <= len(before) < 6
    with run(tmp_path, 6) as second:
        said, _ = second.communicate(timeout=120)
    assert second.returncode == 0
    assert said.split() == ["left", str(6 - len(before))]
    lines = [json.loads(text) for text in path.read_text().splitlines()]
    assert sorted(line["name"] for line in lines) == [f"case-{i}" for i in range(6)], "each once, none torn"


def test_one_run_at_a_time_writes_into_a_file(tmp_path: Path) -> None:
    with (
        open_records(tmp_path / "kept.jsonl"),
        pytest.raises(ConfigError, match="another run is writing"),
        open_records(tmp_path / "kept.jsonl"),
    ):
        pass


def test_a_line_of_another_version_is_not_counted_and_the_newest_of_a_case_is(tmp_path: Path) -> None:
    path = tmp_path / "kept.jsonl"
    with open_records(path) as file:
        for version, verdict in (("a", "adequate"), ("b", "named"), ("b", "tied")):
            append_record(file, {"design": "P1", "name": "bow-1000", "version": version, "verdict": verdict})
    assert read_records(path, version="a")["P1 bow-1000"]["verdict"] == "adequate"
    assert read_records(path, version="b")["P1 bow-1000"]["verdict"] == "tied"
    assert read_records(path, version="c") == {}


def test_the_version_is_that_of_the_sources(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("rotorrig/identify", "rotorrig/app/report", "benchmarks/parts/blind/rigs", "configs"):
        (tmp_path / name).mkdir(parents=True)
    source, report = tmp_path / "rotorrig/identify/model.py", tmp_path / "rotorrig/app/report/page.py"
    source.write_text("a = 1\n")
    (tmp_path / "configs/rk4.toml").write_text("")
    drawing, judging = (tmp_path / f"benchmarks/parts/blind/{name}" for name in ("rigs/drawn.py", "page.py"))
    drawing.write_text("")
    judging.write_text("")
    monkeypatch.setattr(records, "ROOT", tmp_path)
    seen = []
    changes = (
        (source, "a = 1\n"),
        (judging, "other words"),
        (report, "other words"),
        (source, "a = 2\n"),
        (drawing, "b = 1\n"),
    )
    for path, text in changes:
        path.write_text(text)
        seen.append(source_version.__wrapped__())
    assert seen[0] == seen[1] == seen[2], "neither page makes a case"
    assert len(set(seen)) == 3


def test_an_attempt_stands_until_it_is_superseded_and_the_next_has_new_seeds(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(records, "source_version", lambda: "one")
    assert begin_attempt(tmp_path).number == 0
    supersede_attempt("a rehearsal", tmp_path)
    first = begin_attempt(tmp_path)
    assert (first.number, first.first_seed, first.version) == (1, 1000, "one")
    assert begin_attempt(tmp_path) == first, "the same is gone on with"
    with open_records(results_file(first, tmp_path)) as file:
        for i, verdict in enumerate(("adequate", "adequate", "named")):
            append_record(file, {"design": "P2", "name": f"healthy-{i}", "version": "one", "verdict": verdict})

    monkeypatch.setattr(records, "source_version", lambda: "two")
    with pytest.raises(ConfigError, match="attempt 1: is of version one and the code here of two"):
        begin_attempt(tmp_path)
    assert standing_attempt(tmp_path) == first, "its summary can still be had"
    supersede_attempt("a false alarm was looked at", tmp_path)
    assert standing_attempt(tmp_path) is None
    second = begin_attempt(tmp_path)
    assert (second.number, second.first_seed, second.version) == (2, 2000, "two")
    assert choose_attempt(tmp_path) == second
    supersede_attempt("stopped before its first case", tmp_path)
    ended = attempts(tmp_path)[1]
    assert choose_attempt(tmp_path) == ended, "of those that are superseded, the newest that got to a case"
    assert ended.superseded == "a false alarm was looked at"
    assert ended.verdicts == {"adequate": 2, "named": 1}
    with pytest.raises(ConfigError, match="no attempt stands"):
        supersede_attempt("twice", tmp_path / "elsewhere")
