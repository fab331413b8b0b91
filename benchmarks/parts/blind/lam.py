"""What a case's data could show at all: lam of its effect against the base model, and against its nearest rival.

The *analyst's* effect at the size that was hidden is predicted without noise, on the rows and with the noise of a
healthy rig of the same design and the model's own error that its config expects, and the prediction is fitted again: by
the base model alone, with all its nuisances, and by the base model with each rival. What misfit is left, weighted, is
lam; it decides which cases are fair to ask for and is no part of any diagnosis. Of two faults it is computed for each
alone, and the lesser counts.

Rivals are the candidates of a diagnosis but the right answers, and but the same cause at another place along the
shaft. Their scores say by how much each could lower the misfit; those that could come below `ENOUGH` are fitted in
full, the most promising first, those without a first order last, until one is too near to tell apart. How far beyond
`ENOUGH` the nearest is does not matter, and is not found out.
"""

import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypedDict

import numpy as np

from benchmarks.parts.blind.cases import Case, Design
from benchmarks.parts.blind.measured import measure, measured
from benchmarks.parts.blind.names import Answer, answer
from rotorrig.identify.base_fit import BASE_FIT, BaseProblem, SearchOptions, search_and_refine
from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import candidates, scale_of
from rotorrig.identify.causes.nameplate_search import search_from_nameplate
from rotorrig.identify.causes.score_test import Score, scores
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, Recording, nuisance_effects
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.verdict import VERDICT
from rotorrig.identify.verdict.separability import fit_from_starts, separability
from rotorrig.identify.verdict.verdict import is_another_cause
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import Effect, find
from rotorrig.sims.plant import Truth, expected_estimates

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


def is_asked(case: Case) -> bool:
    """Return whether lam is asked for: of a case whose faults are all modelled by effects."""
    return case.kind in ("single", "pair")


def lam_of(case: Case, truth: Truth, folder: Path, *, enough: float = ENOUGH) -> Lam:
    """Return lam of what a case hides; healthy recordings of the RK4 are kept in `folder`."""
    recordings = template(case.design, folder) if not case.is_drawn else recordings_of_healthy(case)
    return lam_on(recordings, case.rig, truth, enough=enough)


def lam_on(recordings: Sequence[Recording], rig: RigConfig, truth: Truth, *, enough: float = ENOUGH) -> Lam:
    """Return lam of what a truth hides on the rows of `recordings`."""
    return _lesser([lam(rig, truth, answer(rig, truth, fault), recordings, enough=enough) for fault in truth.faults])


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
    slight = nuisance_effects(recordings)
    problem = ExtendedProblem(
        ExtendedModel(recordings, (*slight, find(rig, hidden.exact).rescale(scale_of(recordings))))
    )
    p = _vector(problem, expected_estimates(rig, truth), hidden)
    problem = problem.expecting_error(p, of_laws=False)  # it is the analyst's own law that is predicted
    seen = [r.instead(z) for r, z in zip(problem.recordings, problem.model.predict(p), strict=True)]
    base = ExtendedProblem(ExtendedModel(seen, slight, models=problem.model.models))
    best = _fit_base(base, p[: base.parameters.own.start])
    left = max(0.0, best.chi2 - _floor(problem, p))
    if left < VERDICT.detectable:
        return {"lam": left, "rival_lam": left, "rival": ""}
    effect = problem.effects[-1]
    rivals = [e for e in candidates(recordings) if e.label not in hidden.labels and is_another_cause(e, effect)]
    nearest, which = enough, ""
    for search in (
        lambda: scores(base, best.p, rivals),
        lambda: search_from_nameplate(base, best, rivals, biased=True),
    ):
        if nearest < VERDICT.nameable:
            break
        for effect in _promising(search(), left, enough=enough, bent=problem.curved):
            found = _to(problem, p, effect, enough=nearest)
            if found < nearest:
                nearest, which = found, effect.label
            if nearest < VERDICT.nameable:
                break
    return {"lam": left, "rival_lam": min(nearest, left), "rival": which}


def _fit_base(base: ExtendedProblem, p: Reals) -> Solution:
    """Return the best fit of a model without the effect: by full steps, by damped ones, or searched as any base is.

    Beside an effect that changes the rotor much, full steps from the true vector may end in a minimum far from any: of
    a bearing softened to 43 % they left 397,063 of chi2, damped ones 12. Of a bearing on a seat that is softer than it
    both left 86,835, though the base fits: so what seems to be more than the noise of all values is searched for.
    """
    damped = base.solve(
        base.parameters.start(p), tolerance=VERDICT.separated_within, max_steps=VERDICT.separated_steps, damped=True
    )
    best = min(fit_from_starts(base, p), damped, key=lambda fit: fit.chi2)
    if best.chi2 < best.dof:
        return best
    _, _, searched = search_and_refine(BaseProblem.of(base.recordings), SearchOptions(share=BASE_FIT.roughly))
    if searched.chi2 > best.chi2:
        return best
    return base.solve(searched.p, tolerance=VERDICT.separated_within, max_steps=VERDICT.separated_steps)


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
    """Return the recordings of a healthy RK4 of a design, kept in `folder`."""
    return _numbered(measured(Case(design=design, seed=TEMPLATE_SEED), folder).responses)


def recordings_of_healthy(case: Case, *, runs: int | None = None) -> tuple[Recording, ...]:
    """Return recordings of the rig of a case without its faults; `runs` as `measure` has them."""
    with TemporaryDirectory() as scratch:
        sealed = Path(scratch) / "sealed.json"
        return _numbered(measure(case, sealed=sealed, folder=Path(scratch), faults=(), runs=runs))


def _numbered(responses: Sequence[OrderTrackedResponse]) -> tuple[Recording, ...]:
    return tuple(Recording(response, number=i) for i, response in enumerate(responses))
