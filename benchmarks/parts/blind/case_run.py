"""One case from its sealed truth to the line that is kept of it, in pieces as they come.

Swept, tracked, diagnosed from the responses and their nameplate alone; then the truth is opened, and the line gets the
right answers, stiffness and unbalance beside the true ones, and lam of what was hidden.
"""

import json
import math
import tempfile
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.parts.blind.cases import Case
from benchmarks.parts.blind.estimates import estimates
from benchmarks.parts.blind.lam import is_asked, lam_of
from benchmarks.parts.blind.measured import Measured, measured
from benchmarks.parts.blind.nameplate_answers import answer_dimension, answer_rest
from benchmarks.parts.blind.names import Answer, answer
from benchmarks.parts.blind.rigs.drawn import layout
from benchmarks.parts.error_text import error_text
from rotorrig.identify import diagnose, write_diagnosis
from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.plant import Truth, expected_estimates, unseal

ARRAYS = ("residual", "sigmas", "extended_residual", "extended_sigmas")  # of diagnosis.json; not kept
FAILED = "failed"  # for a verdict, of a case that ended in an error
PATIENCE = 200.0  # s of the processor's time, of the five minutes that a diagnosis may take: what is begun is ended
JUDGED = ("adequate", "named")  # verdicts whose stiffness and unbalance are held against the truth

Job = tuple[Case, Path]


def run_case(job: Job) -> Iterator[dict[str, Any]]:
    """Yield the line of a case in pieces; what goes wrong before there is a diagnosis is its result."""
    case, folder = job
    yield {"rig": layout(case.rig) if case.is_drawn else "rk4"}
    began = time.perf_counter()
    try:
        swept = measured(case, folder)
        measuring = time.perf_counter() - began
        yield {"again": swept.case.again, "seconds_measure": measuring}
        began, worked = time.perf_counter(), time.process_time()
        with tempfile.TemporaryDirectory() as scratch:
            found = diagnosed(swept.responses, Path(scratch) / "diagnosis.json")
        spent = {"seconds": time.perf_counter() - began, "seconds_cpu": time.process_time() - worked}
    except Exception:  # a case that crashes counts against the diagnosis and must not end a night's run
        yield {"verdict": FAILED, "error": error_text()}
        return
    truth = unseal(swept.sealed)
    yield {**verdict_part(found), **spent, "hidden": [asdict(each) for each in right_answers(swept.case, truth)]}
    yield from _after(swept, found, truth, folder)


def diagnosed(responses: Sequence[OrderTrackedResponse], out: Path, *, without: Collection[str] = ()) -> dict[str, Any]:
    """Diagnose from the responses and their nameplate alone; write diagnosis.json and return it without its arrays.

    Effects in `without` are left out of the library. After `PATIENCE` it is cut short: what it has by then counts.
    """
    began = time.process_time()
    write_diagnosis(out, diagnose(responses, without=without, go_on=lambda: time.process_time() - began < PATIENCE))
    table = json.loads(out.read_text(encoding="utf-8"))
    return {key: value for key, value in table.items() if key not in ARRAYS}


def verdict_part(diagnosis: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is kept of a diagnosis.json: the verdict, the cause ranked first, those chosen and the ties."""
    causes = diagnosis["causes"]
    return {
        "verdict": diagnosis["verdict"],
        "cut_short": bool(diagnosis.get("cut_short", False)),
        "first": causes[0]["label"] if causes else "",
        "chosen": {c["label"]: {"theta": c["theta"], "sigmas": c["sigmas"]} for c in causes if c["chosen"]},
        "tied": [list(group) for group in diagnosis["tied"]],
        "over_floor": diagnosis["gain"].get("over_noise_floor"),
    }


def right_answers(case: Case, truth: Truth) -> list[Answer]:
    """Return the right answer for every fault, and for everything that is not quite the nameplate's."""
    _, deviations = case.geometry
    faults = [answer(case.rig, truth, fault) for fault in truth.faults]
    return [*faults, *map(answer_dimension, deviations), *answer_rest(case.rig, truth)]


def _after(swept: Measured, found: Mapping[str, Any], truth: Truth, folder: Path) -> Iterator[dict[str, Any]]:
    """Yield what is only known with the truth; what goes wrong with it leaves the diagnosis as it is."""
    case = swept.case
    try:
        if found["verdict"] in JUDGED:
            true = expected_estimates(case.rig, truth)
            got = estimates(found, swept.responses)
            yield {"base": {name: [value, _finite(sigma), true[name]] for name, (value, sigma) in got.items()}}
        if is_asked(case):
            began = time.perf_counter()
            yield {"lam": lam_of(case, truth, folder), "seconds_lam": time.perf_counter() - began}
    except Exception:
        yield {"error_after": error_text()}


def _finite(sigma: float | None) -> float | None:
    """Return a sigma as JSON can have it: None is infinite."""
    return sigma if sigma is not None and math.isfinite(sigma) else None
