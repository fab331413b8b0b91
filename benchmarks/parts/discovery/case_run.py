"""One case from its sealed truth to the line that is kept of it: what is found with every known cause left out."""

import math
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from benchmarks.parts.blind.cases import Case
from benchmarks.parts.blind.measured import measured
from benchmarks.parts.discovery.expected import expected
from benchmarks.parts.error_text import error_text
from rotorrig.identify.base_fit import config_effects, fit_base
from rotorrig.identify.causes import Selection
from rotorrig.identify.discovery import Discovery, discover
from rotorrig.identify.extended_model import recordings_of
from rotorrig.identify.verdict import Unseen
from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.plant import unseal

PATIENCE = 240.0  # s of the processor, after which no further law is tried

Job = tuple[Case, Path]


def run_case(job: Job) -> Iterator[dict[str, Any]]:
    """Yield the line of a case in pieces; what goes wrong is its result."""
    case, folder = job
    try:
        swept = measured(case, folder)
        worked = time.process_time()
        with threadpool_limits(1):
            yield _found(swept.responses)
        yield {"again": swept.case.again, "seconds_cpu": round(time.process_time() - worked, 1)}
    except Exception:  # a case that crashes counts against the search and must not end a night's run
        yield {"error": error_text()}
        return
    truth = unseal(swept.sealed)
    rig = swept.responses[0].rig
    right = [expected(rig, fault) for fault in truth.faults]
    yield {"faults": [asdict(f) for f in truth.faults], "right": [asdict(each) if each else None for each in right]}


def _found(responses: tuple[OrderTrackedResponse, ...]) -> dict[str, Any]:
    """Return what is kept of a discovery: none is made where the base model is adequate."""
    base = fit_base(recordings_of(responses), config_effects(responses[0].rig))
    if base.adequacy.adequate:
        return {"adequate": True}
    nothing = Selection(start=base.problem, base=base.polished, steps=(), problem=base.problem, polished=base.polished)
    until = time.process_time() + PATIENCE
    unseen = Unseen(base.problem, base.polished.p)
    found = discover(base, nothing, unseen, lambda: time.process_time() < until)
    return {"adequate": False, "chi2": base.polished.chi2, "dof": base.polished.dof, **(_line(found) if found else {})}


def _line(found: Discovery) -> dict[str, Any]:
    missing, after = found.missing, found.predictions.after
    mean = float(missing.places @ missing.probability) if missing.places.size else math.nan
    spread = float(((missing.places - mean) ** 2 @ missing.probability) ** 0.5) if missing.places.size else math.nan
    return {
        "kind": missing.kind,
        "words": missing.words,
        "laws": list(missing.laws),
        "place": None if math.isnan(missing.place) else missing.place,
        "sigma": None if math.isnan(missing.place) else max(missing.place_sigma, spread),
        "shortfall": missing.shortfall,
        "over_expected": after.over_expected,
        "over_floor": after.over_floor,
        "before_over_expected": found.predictions.before.over_expected,
        "rivals": [[rival.words, rival.evidence] for rival in missing.rivals],
    }
