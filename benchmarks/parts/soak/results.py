"""Kept results: one JSON line a run, in the repository; the newest line of a run counts."""

import hashlib
import json
import math
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.parts.soak.controllers import ROOT
from benchmarks.parts.soak.judge import Verdict

FOLDER = Path(__file__).parent / "results"
GUARDIAN_PERCENTILE = 0.99
#: what stops a rotor: drivers, guardian, engine, files, and what the operator meets; a sweep loads no identification
TESTED = (
    *(f"rotorrig/rig/{name}" for name in ("connect.py", "control", "interlock", "motor", "probes", "serial_port.py")),
    *(f"rotorrig/acquisition/{name}" for name in ("files", "recording.py", "sweep")),
    *(f"rotorrig/app/{name}" for name in ("cli.py", "commands/sweep.py", "commands/stop.py", "terminal")),
)


def code() -> str:
    """Return what the code under test is: a hash of its files in git, and whether they were changed since."""
    trees = _git("rev-parse", *(f"HEAD:{path}" for path in TESTED))
    dirty = ".dirty" if _git("status", "--porcelain", "-uno", "--", *TESTED) else ""
    return hashlib.sha256(trees.encode()).hexdigest()[:7] + dirty


def keep(verdict: Verdict, *, version: str, folder: Path = FOLDER) -> None:
    """Append a verdict to the results of its set."""
    verdict.code, verdict.date = version, f"{datetime.now(UTC):%Y-%m-%d}"
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / f"{verdict.set}.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(_plain(asdict(verdict))) + "\n")


def kept(folder: Path = FOLDER) -> dict[str, Verdict]:
    """Return the newest verdict of every run."""
    known = {field.name for field in fields(Verdict)}
    verdicts: dict[str, Verdict] = {}
    for path in sorted(folder.glob("*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            verdict = Verdict(**{key: value for key, value in json.loads(line).items() if key in known})
            verdicts[verdict.run] = verdict
    return verdicts


def prune(folder: Path = FOLDER) -> None:
    """Drop the lines that a newer one of the same run has replaced."""
    newest = kept(folder)
    for path in sorted(folder.glob("*.jsonl")):
        mine = [verdict for verdict in newest.values() if verdict.set == path.stem]
        path.write_text("".join(json.dumps(_plain(asdict(verdict))) + "\n" for verdict in mine), encoding="utf-8")


def campaign(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """Return those of singles and pairs: a named case is no part of the campaign."""
    return [verdict for verdict in verdicts if verdict.set != "cases"]


def summary(verdicts: Iterable[Verdict]) -> dict[str, Any]:
    """Return the figures of some runs."""
    counted = list(verdicts)
    stops = sorted(v.guardian_stop_ms for v in counted if v.guardian_stop_ms is not None)
    return {
        "runs": len(counted),
        "pairs": sum(verdict.set == "pairs" for verdict in counted),
        "said_stopped_turning": sum(verdict.said_stopped_turning for verdict in counted),
        "gone_turning": sum(verdict.gone_turning for verdict in counted),
        "tracebacks": sum(bool(verdict.tracebacks) for verdict in counted),
        "samples_lost": sum(verdict.samples_lost for verdict in counted),
        "contradictions": sum(verdict.contradiction for verdict in counted),
        "killed": sum(verdict.killed for verdict in counted),
        "untested": sum(verdict.untested for verdict in counted),
        "guardian_stop_ms_p99": stops[math.ceil(GUARDIAN_PERCENTILE * len(stops)) - 1] if stops else None,
        "cpu_s_per_run": round(sum(v.cpu_s + v.peer_cpu_s for v in counted) / max(1, len(counted)), 1),
    }


def _plain(line: dict[str, Any]) -> dict[str, Any]:
    """Return a line without what JSON cannot say."""
    return {key: None if isinstance(value, float) and math.isnan(value) else value for key, value in line.items()}


def _git(*words: str) -> str:
    done = subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, timeout=10, check=False)
    return done.stdout.strip()
