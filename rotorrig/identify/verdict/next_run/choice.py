"""Next run: the one that tells most per minute about the tied causes, computed for this rig and these causes.

Every plan is simulated with the best cause, as it was fitted, and fitted with each of its rivals (separability.py); the
quickest that tells all of them from the best is proposed, time of hands included; where none does, the one that tells
most per minute. One that may come near a vibration limit (forecast.py) is proposed only if all others do too, and with
its share of the limit. Where nothing is tied and nothing known explains the data, it is a run of another kind that
stays away from the limits.
"""

import cmath
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import Candidate, Selection
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.verdict.next_run.dwells import parting_speeds
from rotorrig.identify.verdict.next_run.forecast import draw_left_open, planned_truth, share_of_limit
from rotorrig.identify.verdict.next_run.plans import Plan, plans, ramp_of
from rotorrig.identify.verdict.separability import separability
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.identify.verdict.verdict import tied_candidates
from rotorrig.rig import ConfigError, DataError
from rotorrig.sims.effects import Effect

LeftOpen = tuple[ExtendedProblem, list[Reals]]  # a fitted model, and the vectors that the data leave open in it

NONE = "none"  # kind of a run that could not be computed


@dataclass(frozen=True, slots=True, kw_only=True)
class NextRun:
    """A run that would tell causes apart which the data at hand cannot, or why none could be computed."""

    kind: str  # "trial mass", "through critical": that of a `Plan`; "none": there is none
    words: str  # what to do, as a sentence, and what it supposes; or why there is none
    lam: float  # expected chi2 between the best cause and the rival that is nearest then; NaN: there is none
    separates: tuple[str, ...]  # labels; none where the run is one of another kind
    top: float = math.nan  # rad/s, the highest speed
    ramp: float = math.nan  # rad/s^2
    speeds: tuple[float, ...] = ()  # rad/s, to hold one after the other instead of a sweep
    minutes: float = math.nan  # it takes, about, with the time of hands
    trial: tuple[str, ...] = ()  # masses to mount, "disk: 12 g mm at 90 deg"
    share_of_limit: float = math.nan  # of vibration, at the most with 95 % probability; NaN: the config has no limits

    @property
    def planned(self) -> bool:
        """Whether there is one."""
        return self.kind != NONE


def find_next_run(selection: Selection, *, not_possible: Collection[str] = ()) -> NextRun | None:
    """Return the quickest run that separates the first set of tied causes; None: nothing is tied.

    Where none separates them it is the one that tells most per minute. Causes that are tied never go without: where no
    plan can be computed, the words say why. Kinds of plans in `not_possible` are passed over.
    """
    groups = tied_candidates(selection)
    if not groups:
        return None
    labels = tuple(candidate.effect.label for candidate in groups[0])
    failed: list[str] = []
    try:
        best = _choose_plan(groups[0], not_possible, failed)
    except _FAILURES as error:
        return _none([*failed, str(error)], labels)
    if not best:
        return _none(failed, labels)
    enough = "" if best.lam >= VERDICT.nameable else "Even that would leave them close."
    return _next_run(best.plan, best.share, enough, lam=best.lam, separates=labels)


@dataclass(frozen=True, slots=True)
class _Rated:
    """A plan and what it is worth."""

    plan: Plan
    lam: float  # of the nearest rival with it
    share: float = math.nan  # of a limit that it may reach, once that is forecast

    @property
    def rank(self) -> tuple[bool, float]:
        """What is more is better: telling anything, most per minute."""
        return self.lam >= VERDICT.worthwhile, self.lam / self.plan.seconds


def _choose_plan(tied: Sequence[Candidate], not_possible: Collection[str], failed: list[str]) -> _Rated | None:
    """Return the best plan that is calm, or else the best; why others cannot be made goes to `failed`.

    A forecast takes as long as a fit: it is made of what may be chosen alone.
    """
    fits = [(each.problem, each.polished) for each in tied]
    dwells = () if "dwells" in not_possible else parting_speeds(fits[0], fits[1:])
    unbalance = _find_unbalance(*fits[0])
    possible = _open_plans(tied[0].problem.recordings, not_possible, unbalance=unbalance, dwells=dwells)
    left_open: list[LeftOpen] = []
    loud = None
    for each in _best_first(_rate_plans(tied, sorted(possible, key=lambda plan: plan.seconds), failed)):
        left_open = left_open or [(problem, draw_left_open(problem, fit)) for problem, fit in fits]
        share, why = _forecast(left_open, each.plan)
        if why:
            failed.append(f"{each.plan.kind}: {why}")
        elif not _is_loud(share):
            return replace(each, share=share)
        else:
            loud = loud or replace(each, share=share)
    return loud


def _rate_plans(tied: Sequence[Candidate], possible: Sequence[Plan], failed: list[str]) -> Iterator[_Rated]:
    """Yield plans and what they tell; why others cannot be rated goes to `failed`."""
    best, *rivals = tied
    for plan in possible:
        lam, why = _rate(best, rivals, plan)
        if why:
            failed.append(f"{plan.kind}: {why}")
        else:
            yield _Rated(plan, lam)


def _best_first(rated: Iterator[_Rated]) -> Iterator[_Rated]:
    """Yield the plans that tell the causes apart as they come, and then the others, by what they are worth."""
    others = []
    for each in rated:
        if each.lam >= VERDICT.nameable:
            yield each
        else:
            others.append(each)
    yield from sorted(others, key=lambda each: each.rank, reverse=True)


def find_other_run(selection: Selection, *, not_possible: Collection[str] = ()) -> NextRun:
    """Return a run of another kind than those made: for data that nothing known explains, or that can tell little.

    Through a critical speed if it may be, for there causes show; then with a trial mass, slower, in a second plane.
    """
    failed: list[str] = []
    fits = [(selection.start, selection.base), (selection.problem, selection.polished)]
    try:
        unbalance = _find_unbalance(selection.problem, selection.polished)
        left_open = [(problem, draw_left_open(problem, fit)) for problem, fit in fits]
        open_plans = _open_plans(selection.problem.recordings, not_possible, unbalance=unbalance)
        for plan in sorted(open_plans, key=lambda plan: (_TELLING.index(plan.kind), -plan.high, plan.ramp)):
            share, why = _forecast(left_open, plan)
            if _is_loud(share):
                most = 100 * VERDICT.of_limit
                why = f"its vibration may reach {100 * share:.0f} % of a limit, want {most:.0f} %"
            if not why:
                return _next_run(plan, share, "")
            failed.append(f"{plan.kind}: {why}")
    except _FAILURES as error:
        failed.append(str(error))
    return _none(failed, ())


def _next_run(plan: Plan, share: float, more: str, *, lam: float = math.nan, separates: Sequence[str] = ()) -> NextRun:
    trial = [f"{disk}: {abs(u) * 1e6:g} g mm at {math.degrees(cmath.phase(u)):g} deg" for disk, u in plan.trial.items()]
    return NextRun(
        kind=plan.kind,
        words=" ".join(filter(None, (plan.words, more, plan.assumed))),
        lam=lam,
        separates=tuple(separates),
        top=plan.high,
        ramp=plan.ramp,
        speeds=plan.dwells,
        minutes=plan.seconds / 60,
        trial=tuple(trial),
        share_of_limit=share,
    )


def _none(failed: Sequence[str], labels: tuple[str, ...]) -> NextRun:
    why = "; ".join(dict.fromkeys(failed)) or "every run this rig can make has been made"
    return NextRun(kind=NONE, words=f"No next run could be computed: {why}.", lam=math.nan, separates=labels)


#: kinds of plans, those first that show most of what may be wrong
_TELLING = ("through critical", "trial mass", "ramp rate", "second plane", "reverse rotation")

#: what a plan may fail by: no motion, a matrix without an inverse, a number that is none
_FAILURES = (DataError, ConfigError, ValueError, ArithmeticError)


def _find_unbalance(problem: ExtendedProblem, fit: Solution) -> complex:
    """Return the unbalance that a fit found on the first plane [kg m]."""
    re, im = fit.p[problem.parameters.base.unbalance][:2]
    return complex(re, im)


def _open_plans(
    measured: Sequence[Recording],
    not_possible: Collection[str],
    *,
    unbalance: complex,
    dwells: Sequence[float] = (),
) -> Iterator[Plan]:
    """Yield the possible plans for a rig whose recordings are `measured`, that were not made yet."""
    with_trial = any(run.trial_unbalance for recording in measured for run in recording.response.runs)
    for plan in plans(measured[0].response, with_trial=with_trial, unbalance=unbalance, dwells=dwells):
        made = plan.backward and any(recording.backward for recording in measured)
        if not (made or plan.kind in not_possible or _was_made(plan, measured)):
            yield plan


def _was_made(plan: Plan, measured: Sequence[Recording]) -> bool:
    """Return whether a later recording than the first was run like that, as fast and as far; or held speeds."""
    if plan.kind == "dwells":
        return any(all(run.direction == 0 for run in each.response.runs) for each in measured[1:])
    if plan.kind not in ("ramp rate", "through critical"):
        return False
    for recording in measured[1:]:
        alike = abs(math.log(ramp_of(recording.response) / plan.ramp)) < math.log(1.5)  # false of NaN
        if alike and float(recording.response.omega.max()) > 0.95 * plan.high:
            return True
    return False


def _forecast(left_open: Sequence[LeftOpen], plan: Plan) -> tuple[float, str]:
    """Return the share of a limit that a plan may reach by any of the fits, and why it is not known, empty if it is.

    Where the config has no limits it is NaN.
    """
    limits = plan.rig.limits
    if limits is None:
        return math.nan, ""
    try:
        share = max(share_of_limit(problem, vectors, plan, limits) for problem, vectors in left_open)
    except _FAILURES as error:
        return math.nan, str(error)
    return share, "" if math.isfinite(share) else "its forecast is not finite"


def _is_loud(share: float) -> bool:
    """Say whether a run may come too near a limit."""
    return share > VERDICT.of_limit


def _rate(best: Candidate, rivals: Sequence[Candidate], plan: Plan) -> tuple[float, str]:
    """Return lambda of the nearest rival with a plan's recordings too, and why there is none, empty if there is one.

    The fit of a rival that could not come nearer than those before it is given up.
    """
    lams: list[float] = []
    try:
        truth, p = planned_truth(best.problem, best.polished.p, plan)
        unknown = truth.effects[: len(truth.effects) - len(best.problem.effects)]
        for rival in rivals:
            nearest = min(lams, default=math.inf)
            lams.append(_separability(truth, p, (*unknown, *rival.problem.effects), enough=nearest))
    except _FAILURES as error:
        return math.nan, str(error)
    lam = min(lams)
    return lam, "" if math.isfinite(lam) else "its prediction is not finite"


def _separability(truth: ExtendedProblem, p: Reals, rival: Sequence[Effect], *, enough: float) -> float:
    """Return lambda of a rival, some value above `enough` if it is more; none where nobody knows what would show."""
    try:
        return separability(truth.expecting_error(p), p, rival, enough=enough)
    except DataError:  # a force law, in a rotor that turns backwards
        return 0.0
