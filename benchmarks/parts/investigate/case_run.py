"""One investigation of a simulated rig, from its sealed truth to the line that is kept of it."""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks.parts.blind.cases import Case, draw_again, sizes
from benchmarks.parts.blind.lam import lam_on, recordings_of_healthy
from benchmarks.parts.blind.names import answer
from benchmarks.parts.error_text import error_text
from rotorrig.app.commands.investigate import investigate, prepare
from rotorrig.app.commands.simulate import SimulatedRig
from rotorrig.app.terminal import out
from rotorrig.investigation import Budget, Journal
from rotorrig.rig import RigError
from rotorrig.sims.plant import draw, seal, unseal

RATE = 60.0  # simulated seconds per second, at most
MOST_DRAWS = 6
RUNS = 6
LAM_RUNS = 2  # by which it is said what can be told apart: the plan's, and the same with a trial mass


def run_case(case: Case) -> Iterator[dict[str, Any]]:
    """Yield the line of a case; what goes wrong is its result."""
    out.quiet = True
    try:
        yield from _investigated(case)
    except Exception:  # a case that crashes counts against the investigation and must not end a night's run
        yield {"error": error_text()}


def _investigated(case: Case) -> Iterator[dict[str, Any]]:
    """Investigate one rig, drawn again where its first run trips; the truth is opened at the end."""
    for _ in range(MOST_DRAWS):
        with tempfile.TemporaryDirectory() as scratch:
            sealed = Path(scratch) / "sealed.json"
            geometry, _ = case.geometry
            seal(replace(draw(case.rig, seed=case.plant_seed, faults=sizes(case)), geometry=geometry), sealed)
            setup = prepare(
                case.rig,
                config=Path("none.toml"),
                folder=Path(scratch) / "found",
                plan="default",
                budget=Budget(runs=RUNS),
                simulation=SimulatedRig(seed=case.seed, hidden=sealed, rate=RATE),
            )
            try:
                journal, diagnosis = investigate(setup)
            except RigError as error:
                if list((Path(scratch) / "found").glob("response-*")):
                    yield {"again": case.again, "verdict": "tripped", "error": str(error)}
                    return
                case = draw_again(case)
                continue
            truth = unseal(sealed)
            right = {label for fault in truth.faults for label in answer(case.rig, truth, fault).labels}
            named = [cause.label for cause in diagnosis.causes if cause.chosen]
            yield {"again": case.again, **line(journal, named, [list(t) for t in diagnosis.tied], right)}
            yield {"lam": lam_on(recordings_of_healthy(case, runs=LAM_RUNS), case.rig, truth)}
            return
    yield {"again": case.again, "verdict": "tripped", "error": "every first run"}


def line(journal: Journal, named: Sequence[str], tied: Sequence[Sequence[str]], right: set[str]) -> dict[str, Any]:
    """Return what is kept of an investigation."""
    first = journal.judged[0]
    return {
        "verdict": str(journal.judged[-1].verdict),
        "named": list(named),
        "tied": list(tied),
        "right": sorted(right),
        "first_verdict": str(first.verdict),
        "first_beliefs": [each.label for each in first.beliefs],
        "runs": [{"plan": r.plan, "trial": list(r.trial), "seconds": r.seconds} for r in journal.judged],
        "why_ended": journal.ending,
    }
