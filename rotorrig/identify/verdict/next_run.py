"""Next run: the cheapest that would separate the tied causes, computed for this rig and these causes.

Every plan is simulated with the best cause, as it was fitted, and fitted with each of its rivals (separability.py); the
cheapest that tells all of them from the best is proposed, or the one that comes nearest.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import Candidate, Selection
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem
from rotorrig.identify.verdict.planned_runs import Plan, plan_recordings, plans
from rotorrig.identify.verdict.separability import separability
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.identify.verdict.verdict import tied_candidates
from rotorrig.rig import ConfigError, DataError
from rotorrig.sims.effects import Effect

NONE = "none"  # kind of a run that could not be computed


@dataclass(frozen=True, slots=True, kw_only=True)
class NextRun:
    """A run that would tell causes apart which the data at hand cannot, or why none could be computed."""

    kind: str  # "trial mass", "through critical": that of a `Plan`; "none": there is none
    words: str  # what to do, as a sentence, and what it supposes; or why there is none
    lam: float  # expected chi2 between the best cause and the rival that is nearest then; NaN: there is none
    separates: tuple[str, ...]  # labels

    @property
    def planned(self) -> bool:
        """Whether there is one."""
        return self.kind != NONE


def find_next_run(selection: Selection) -> NextRun | None:
    """Return the cheapest run that separates the first set of tied causes, or comes nearest; None: nothing is tied.

    Causes that are tied never go without: where no plan can be computed, the words say why.
    """
    groups = tied_candidates(selection)
    if not groups:
        return None
    best, *rivals = groups[0]
    labels = tuple(candidate.effect.label for candidate in (best, *rivals))
    rated: list[tuple[float, Plan]] = []
    failed: list[str] = []
    try:
        for plan in _open_plans(best):
            lam, why = _rate(best, rivals, plan)
            if why:
                failed.append(f"{plan.kind}: {why}")
                continue
            rated.append((lam, plan))
            if lam >= VERDICT.nameable:
                break
    except _FAILURES as error:
        failed.append(str(error))
    if not rated:
        why = "; ".join(dict.fromkeys(failed)) or "every run this rig can make has been made"
        return NextRun(kind=NONE, words=f"No next run could be computed: {why}.", lam=math.nan, separates=labels)
    lam, plan = max(rated, key=lambda pair: pair[0])
    enough = "" if lam >= VERDICT.nameable else "Even that would leave them close."
    words = " ".join(filter(None, (plan.words, enough, plan.assumed)))
    return NextRun(kind=plan.kind, words=words, lam=lam, separates=labels)


#: what a plan may fail by: no motion, a matrix without an inverse, a number that is none
_FAILURES = (DataError, ConfigError, ValueError, ArithmeticError)


def _open_plans(best: Candidate) -> Iterator[Plan]:
    """Yield the plans for the recordings of a candidate that were not made yet."""
    measured = best.problem.recordings
    with_trial = any(run.trial_unbalance for recording in measured for run in recording.response.runs)
    for plan in plans(measured[0].response, with_trial=with_trial):
        if not (plan.backward and any(recording.backward for recording in measured)):
            yield plan


def _rate(best: Candidate, rivals: Sequence[Candidate], plan: Plan) -> tuple[float, str]:
    """Return lambda of the nearest rival in the recordings of a plan, and why there is none, empty if there is one.

    The fit of a rival that could not come nearer than those before it is given up.
    """
    lams: list[float] = []
    try:
        truth, p = _planned_truth(best, plan)
        for rival in rivals:
            nearest = min(lams, default=math.inf)
            lams.append(_separability(truth, p, (*plan.unknown, *rival.problem.effects), enough=nearest))
    except _FAILURES as error:
        return math.nan, str(error)
    lam = min(lams)
    return lam, "" if math.isfinite(lam) else "its prediction is not finite"


def _planned_truth(best: Candidate, plan: Plan) -> tuple[ExtendedProblem, Reals]:
    """Return the problem of a plan's recordings with the best cause in the model, and its unknowns as fitted."""
    recordings = plan_recordings(best.problem.recordings[0].response, plan)
    effects = (*plan.unknown, *best.problem.effects)
    truth = ExtendedProblem(ExtendedModel(recordings, effects, widened=best.problem.model.widened))
    named = dict(zip(best.problem.parameters.names, best.polished.p, strict=True))
    p = truth.parameters.start(best.polished.p[:0])
    for i, name in enumerate(truth.parameters.names):
        p[i] = named.get(name, p[i])
    return truth, p


def _separability(truth: ExtendedProblem, p: Reals, rival: Sequence[Effect], *, enough: float) -> float:
    """Return lambda of a rival, some value above `enough` if it is more; none where nobody knows what would show."""
    try:
        return separability(truth.expecting_error(p), p, rival, enough=enough)
    except DataError:  # a force law, in a rotor that turns backwards
        return 0.0
