"""What a case's data could show at all: lam of its effect against the base model, and against its nearest rival.

The *analyst's* effect at the size that was hidden is predicted without noise, on the rows and with the noise of a
healthy rig of the same design, and the prediction is fitted again: by the base model alone, with all its nuisances, and
by the base model with each rival. What misfit is left, weighted, is lam; it decides which cases are fair to ask for and
is no part of any diagnosis. Computed once a case and kept beside it; of two faults for each alone, and the lesser kept.

Rivals are the candidates of a diagnosis but the right answers, and but the same cause at another place along the
shaft. Their scores say by how much each could lower the misfit; those that could come below `ENOUGH` are fitted in
full, the most promising first, those without a first order last, until one is too near to tell apart. How far beyond
`ENOUGH` the nearest is does not matter, and is not found out.
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

from benchmarks.parts.blind.cases import Case, Design, files, write_whole
from benchmarks.parts.blind.measured import measured
from benchmarks.parts.blind.names import Answer, answer
from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import background, candidates
from rotorrig.identify.causes.score_test import Score, curved_scores, scores
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, Recording
from rotorrig.identify.verdict import VERDICT
from rotorrig.identify.verdict.separability import fit_from_starts, separability
from rotorrig.identify.verdict.verdict import is_another_cause
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import Effect, find
from rotorrig.sims.plant import Truth, expected_estimates, unseal

TEMPLATE_SEED = -1  # of the healthy case whose rows and noise are used; no case of the benchmark has it
ENOUGH = (
    VERDICT.detectable
)  # lam to a rival beyond which it is not asked how far: it is more than tells two causes apart
FITTED = 4  # kinds of rivals that are fitted at most, and as many of those without a first order


class Lam(TypedDict):
    """What is left of the misfit by the base and by the nearest rival, and which that is; "": none is near.

    Without a near one, `rival_lam` is no more than `ENOUGH`: a lower bound.
    """

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


def asked(case: Case) -> bool:
    """Return whether lam is asked for: of a case whose faults are all modelled by effects."""
    return case.kind in ("single", "pair")


def compute(job: tuple[Case, Path]) -> None:
    """Compute and keep lam of a case; what goes wrong is written down instead."""
    case, folder = job
    table: dict[str, Any]
    try:
        truth = unseal(files(case, folder)[1])
        recordings = template(case.design, folder)
        each = [lam(case.rig, truth, answer(case.rig, truth, fault), recordings) for fault in truth.faults]
        table = {"found": _lesser(each)}
    except Exception:  # the case then counts in no rate that asks for lam
        table = {"found": None, "error": traceback.format_exc()}
    write_whole(lam_file(case, folder), table)


def _lesser(each: Sequence[Lam]) -> Lam:
    """Return what could be seen of every one of several faults, and told from its nearest rival."""
    nearest = min(each, key=lambda found: found["rival_lam"])
    return {**nearest, "lam": min(found["lam"] for found in each)}


def lam(
    rig: RigConfig, truth: Truth, hidden: Answer, recordings: Sequence[Recording], *, enough: float = ENOUGH
) -> Lam:
    """Return lam of the hidden effect on the rows of `recordings`: to the base, to the nearest rival, and which.

    A rival is not followed beyond `enough`.
    """
    slight = background(rig)
    problem = ExtendedProblem(ExtendedModel(recordings, (*slight, find(rig, hidden.exact))))
    p = _vector(problem, expected_estimates(rig, truth), hidden)
    seen = [r.instead(z) for r, z in zip(recordings, problem.model.predict(p), strict=True)]
    base = ExtendedProblem(ExtendedModel(seen, slight, models=problem.model.models))
    best = fit_from_starts(base, p[: base.parameters.own.start])
    left = max(0.0, best.chi2 - _floor(problem, p))
    if left < VERDICT.detectable:
        return {"lam": left, "rival_lam": left, "rival": ""}
    effect = problem.effects[-1]
    rivals = [e for e in candidates(recordings) if e.label not in hidden.labels and is_another_cause(e, effect)]
    nearest, which = enough, ""
    for scored in (scores, curved_scores):
        if nearest < VERDICT.nameable:
            break
        for effect in _promising(scored(base, best.p, rivals), left, enough=enough, bent=problem.curved):
            found = _to(problem, p, effect, enough=nearest)
            if found < nearest:
                nearest, which = found, effect.label
            if nearest < VERDICT.nameable:
                break
    return {"lam": left, "rival_lam": min(nearest, left), "rival": which}


def _promising(scored: Sequence[Score], left: float, *, enough: float, bent: bool) -> list[Effect]:
    """Return the rivals that could leave less than `enough` of what the base has `left`: the best of every kind.

    Scores, best first, are linear; under the force law of a `bent` truth, or that of a rival, a fit may gain far more
    than they say. The first is followed whatever it says, if it has a first order.
    """
    kinds: dict[str, Effect] = {}
    for score in scored:
        bends = bent or score.effect.needs_starts
        could = left - (VERDICT.hoped_of_laws if bends else VERDICT.hoped) * score.lam < enough
        if could or (not kinds and not score.effect.needs_starts):
            kinds.setdefault(score.effect.name, score.effect)
    return list(kinds.values())[:FITTED]


def _to(problem: ExtendedProblem, p: Reals, rival: Effect, *, enough: float) -> float:
    """Return lam to a rival, beside the nuisances; infinite where under its force law there is no motion."""
    try:
        return separability(problem, p, (*problem.effects[:-1], rival), enough=enough)
    except DataError:
        return math.inf


def _floor(problem: ExtendedProblem, p: Reals) -> float:
    own = problem.parameters.prior_residual(p)
    return float(own @ own)


def _vector(problem: ExtendedProblem, sought: dict[str, float], hidden: Answer) -> Reals:
    """Return the parameters of a rig as it was hidden, its nuisances at the nameplate."""
    names = problem.parameters
    p = names.start(np.zeros(len(names.base)))
    space = names.base.space
    p[names.base.sought] = space.to_working(np.array([sought[name] for name in space.names]))
    amounts = [sought[a.name] * np.exp(1j * sought[f]) for a, f in zip(space.amounts, space.phases, strict=True)]
    p[names.base.unbalance] = [part for u in amounts for part in (u.real, u.imag)]
    p[names.theta[-1]] = [hidden.theta[q.name] / q.size for q in problem.effects[-1].parameters]
    return p


@cache
def template(design: Design, folder: Path) -> tuple[Recording, ...]:
    """Return the recordings of a healthy rig of a design, kept in `folder`."""
    with TemporaryDirectory() as scratch:
        case = Case(design=design, seed=TEMPLATE_SEED)
        responses = measured(case, folder, sealed=Path(scratch) / "sealed.json")
        return tuple(Recording(response, number=i) for i, response in enumerate(responses))
