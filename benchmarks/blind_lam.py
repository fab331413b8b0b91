"""What a case's data could show at all: lam of its effect against the base model, and against its nearest rival.

The *analyst's* effect at the size that was hidden is predicted without noise, on the rows and with the noise of a
healthy rig of the same design, and the prediction is fitted again: by the base model alone, and by the base model with
each rival. What misfit is left, weighted, is lam; it decides which cases are fair to ask for and is no part of any
diagnosis. Computed once a case and kept beside it. Rivals are every effect of the library but the right answers; a
linearisation ranks them and the nearest few are fitted in full, and those that have no linearisation, until one is too
near. An effect that cannot be seen is not compared.
"""

import json
import math
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypedDict

import numpy as np

from benchmarks.blind_cases import Case, Design, files, write_whole
from benchmarks.blind_measured import measured
from benchmarks.blind_names import Answer, answer
from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.parameters import Reals
from rotorrig.identify.recording import Recording
from rotorrig.identify.scores import scores
from rotorrig.identify.separation import DETECTABLE, NAMEABLE, fitted, separation
from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, catalogue, find
from rotorrig.sims.plant.truth import Truth, identified_truth, unseal

TEMPLATE_SEED = -1  # of the healthy case whose rows and noise are used; no case of the benchmark has it
FITTED = 3  # rivals fitted in full
FAR = 1e3  # lam to the nearest linear rival beyond which a linear effect is not taken for one without linearisation


class Lam(TypedDict):
    """What is left of the misfit by the base and by the nearest rival, and which that is."""

    lam: float
    rival_lam: float
    rival: str


def lam_file(case: Case, folder: Path) -> Path:
    """Return where lam of a case is kept."""
    return folder / case.design / f"{case.name}.lam.json"


def lam_of(case: Case, folder: Path) -> Lam | None:
    """Return "lam", "rival_lam" and the "rival" of a case; None if they were not computed, or could not be."""
    path = lam_file(case, folder)
    found: Lam | None = json.loads(path.read_text(encoding="utf-8"))["found"] if path.exists() else None
    return found


def compute(job: tuple[Case, Path]) -> str:
    """Compute and keep lam of a case of one fault, and return its name; what goes wrong is written down instead."""
    case, folder = job
    table: dict[str, Any]
    try:
        truth = unseal(files(case, folder)[1])
        hidden = answer(case.rig, truth, truth.faults[0])
        table = {"found": lam(case.rig, truth, hidden, template(case.design, folder))}
    except Exception:  # the case then counts as one that can be seen and named
        table = {"found": None, "error": traceback.format_exc()}
    write_whole(lam_file(case, folder), table)
    return f"{case.design} {case.name}"


def lam(rig: RigConfig, truth: Truth, hidden: Answer, recordings: Sequence[Recording]) -> Lam:
    """Return lam of the hidden effect on the rows of `recordings`: to the base, to the nearest rival, and which."""
    effect = find(rig, hidden.exact)
    problem = ExtendedProblem(recordings, (effect,))
    p = _vector(problem, identified_truth(rig, truth), hidden)
    seen = [r.instead(z) for r, z in zip(recordings, problem.predict(p), strict=True)]
    base = ExtendedProblem(seen, (), models=problem.models)
    own = problem.parameters.prior_residual(p)
    best = fitted(base, p)
    left = max(0.0, best.chi2 - float(own @ own))
    if left < DETECTABLE:
        return {"lam": left, "rival_lam": left, "rival": ""}
    rivals = [e for e in catalogue(rig) if e.label not in hidden.labels]
    nearest, which = _nearest_rival(problem, p, base, best.p, rivals)
    return {"lam": left, "rival_lam": min(nearest, left), "rival": which}


def _nearest_rival(
    problem: ExtendedProblem, p: Reals, base: ExtendedProblem, best: Reals, rivals: Sequence[Effect]
) -> tuple[float, str]:
    """Return lam of the rival that leaves least, and its label; one that is too near to tell apart ends the search."""
    bent = {e.label for e in rivals if any(q.starts for q in e.parameters)}
    linear = [s.effect for s in scores(base, best, [e for e in rivals if e.label not in bent])[:FITTED]]
    nearest, which = math.inf, ""
    for effect in (*linear, *(e for e in rivals if e.label in bent)):
        far = nearest > FAR and not any(q.starts for q in problem.effects[0].parameters)
        if nearest < NAMEABLE or (effect.label in bent and far):
            break
        left = separation(problem, p, (effect,))
        if left < nearest:
            nearest, which = left, effect.label
    return nearest, which


def _vector(problem: ExtendedProblem, sought: dict[str, float], hidden: Answer) -> Reals:
    """Return the parameters of a rig as it was hidden, its nuisances at the nameplate."""
    names = problem.parameters
    p = names.start(np.zeros(len(names.base)))
    space = names.base.space
    p[names.base.sought] = space.to_working(np.array([sought[name] for name in space.names]))
    amounts = [sought[a.name] * np.exp(1j * sought[f]) for a, f in zip(space.amounts, space.phases, strict=True)]
    p[names.base.unbalance] = [part for u in amounts for part in (u.real, u.imag)]
    p[names.own] = [hidden.theta[q.name] / q.size for q in problem.effects[0].parameters]
    return p


@cache
def template(design: Design, folder: Path) -> tuple[Recording, ...]:
    """Return the recordings of a healthy rig of a design, kept in `folder`."""
    with TemporaryDirectory() as scratch:
        case = Case(design=design, seed=TEMPLATE_SEED)
        responses = measured(case, folder, sealed=Path(scratch) / "sealed.json")
        return tuple(Recording(response, number=i) for i, response in enumerate(responses))
