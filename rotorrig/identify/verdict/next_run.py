"""Next run: the cheapest that would separate the tied causes, computed for this rig and these causes.

Every plan is simulated with the best cause, as it was fitted, and fitted with each of its rivals (separability.py); the
cheapest that tells all of them from the best is proposed, or the one that comes nearest.
"""

from dataclasses import dataclass

from rotorrig.identify.causes import Candidate, Selection
from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem
from rotorrig.identify.verdict.planned_runs import Plan, plan_recordings, plans
from rotorrig.identify.verdict.separability import separability
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.identify.verdict.verdict import tied_candidates
from rotorrig.rig import DataError


@dataclass(frozen=True, slots=True, kw_only=True)
class NextRun:
    """A run that would tell causes apart which the data at hand cannot."""

    kind: str  # "trial mass", "through critical": that of a `Plan`
    words: str  # what to do, as a sentence
    lam: float  # expected chi2 between the best cause and the rival that is nearest then
    separates: tuple[str, ...]  # labels


def find_next_run(selection: Selection) -> NextRun | None:
    """Return the cheapest run that separates the first set of tied causes, or comes nearest; None: nothing is tied."""
    groups = tied_candidates(selection)
    if not groups:
        return None
    best, *rivals = groups[0]
    rated: list[tuple[float, Plan]] = []
    measured = best.problem.recordings
    for plan in plans(measured[0].response):
        if plan.backward and any(recording.backward for recording in measured):
            continue
        lam = min(_separability(best, rival, plan) for rival in rivals)
        rated.append((lam, plan))
        if lam >= VERDICT.nameable:
            break
    if not rated:
        return None
    lam, plan = max(rated, key=lambda pair: pair[0])
    labels = tuple(candidate.effect.label for candidate in (best, *rivals))
    enough = "" if lam >= VERDICT.nameable else " Even that would leave them close."
    return NextRun(kind=plan.kind, words=plan.words + enough, lam=lam, separates=labels)


def _separability(best: Candidate, rival: Candidate, plan: Plan) -> float:
    """Return lambda of a rival in the recordings of a plan; none where nobody knows what these would show."""
    recordings = plan_recordings(best.problem.recordings[0].response, plan)
    truth = ExtendedProblem(ExtendedModel(recordings, (*plan.unknown, *best.problem.effects)))
    named = dict(zip(best.problem.parameters.names, best.polished.p, strict=True))
    p = truth.parameters.start(best.polished.p[:0])
    for i, name in enumerate(truth.parameters.names):
        p[i] = named.get(name, p[i])
    try:
        return separability(truth, p, (*plan.unknown, *rival.problem.effects))
    except DataError:  # a force law, in a rotor that turns backwards
        return 0.0
