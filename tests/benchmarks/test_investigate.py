"""What is counted of investigations."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import cloudpickle

from benchmarks.investigate import in_order, summarise
from benchmarks.parts.alone import pack
from benchmarks.parts.blind.cases import Case
from benchmarks.parts.investigate.case_run import run_case

ROOT = Path(__file__).parents[2]


def kept(name: str, verdict: str, named: list[str], right: list[str], *, first: str = "named", **more: Any) -> Any:
    line = {"name": name, "version": "v", "verdict": verdict, "named": named, "right": right, "first_verdict": first}
    return {**line, "first_beliefs": named, "runs": [{}, {}], **more}


def test_right_wrong_and_resolved_are_counted_apart() -> None:
    lines = [
        kept("bow-1", "named", ["bow"], ["bow", "bow, even"], lam={"lam": 200.0, "rival_lam": 25.0, "rival": ""}),
        kept("delay-1", "named", ["delay"], ["delay"], first="tied"),
        kept("rub-1", "named", ["friction"], ["rub"]),
        kept(
            "runout-1",
            "tied",
            ["bow"],
            ["runout, plane 1"],
            first="tied",
            first_beliefs=["bow", "runout, plane 1"],
            lam={"lam": 60.0, "rival_lam": 15.9, "rival": "bow"},
        ),
        kept("crack-1", "unexplained", [], ["crack"], first="unexplained", lam={"lam": 60.0, "rival_lam": 16.0}),
        {"name": "drag-1", "version": "v", "verdict": "tripped"},
        {"name": "couple-1", "version": "v", "ending": "killed"},
    ]
    found = summarise(lines, wanted=10)
    assert (found["named_right"]["hits"], found["named_right"]["of"]) == (2, 7)
    of_nameable = found["named_right_of_nameable"]
    assert (of_nameable["hits"], of_nameable["of"]) == (1, 2)  # only those of which two runs could name the cause
    assert found["named_right_first"]["hits"] == 1
    assert (found["ties_resolved"]["hits"], found["ties_resolved"]["of"]) == (1, 2)
    assert (found["wrong_unique"], found["still_tied"]) == (1, 1)
    assert (found["limit_trips"], found["unfinished"], found["runs_median"]) == (1, 1, 2)
    assert (found["cases"], found["wanted"], found["version"]) == (7, 10, ["v"])


def test_a_case_can_be_sent_to_a_worker() -> None:
    case = Case(design="P1", faults=("bow",), seed=0)
    work, sent = cloudpickle.loads(pack(run_case, case))
    assert (work, sent) == (run_case, case)


def test_the_order_is_random_and_always_the_same() -> None:
    cases = [Case(design="P1", faults=("bow",), seed=seed) for seed in range(20)]
    assert in_order(cases) == in_order(cases) != cases
    assert sorted(case.seed for case in in_order(cases)) == list(range(20))


def test_a_fresh_clone_prints_what_is_kept() -> None:
    command = [sys.executable, "benchmarks/investigate.py", "--summary", "--json"]
    printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    found = json.loads(printed.stdout.splitlines()[-1])
    assert {"named_right", "ties_resolved", "wrong_unique", "runs_median", "limit_trips", "version"} <= set(found)
