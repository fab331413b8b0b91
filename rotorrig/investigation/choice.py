"""Which run to make next, by the last diagnosis; or why there is none."""

from collections.abc import Callable
from dataclasses import dataclass

from rotorrig.identify import Diagnosis, Verdict
from rotorrig.identify.verdict import VERDICT
from rotorrig.investigation.budget import Budget
from rotorrig.investigation.journal import Journal
from rotorrig.investigation.menu import Menu

OPEN = {
    Verdict.UNEXPLAINED: "Nothing known explains the runs so far.",
    Verdict.DESCRIBED: "What is missing was found, but it is none of the causes that are known.",
    Verdict.CANNOT_TELL: "Fewer than half of the known causes would show in the runs so far.",
    Verdict.TIED: "The config may be wrong in more than one way.",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A run to make."""

    plan: str
    trial: tuple[str, ...]  # masses to have on the rotor
    why: str
    unseen: bool = False  # no fit is to see it
    speeds: tuple[float, ...] = ()  # rad/s, to hold instead of those of the plan


@dataclass(frozen=True, slots=True)
class Ending:
    """Why no run follows."""

    why: str


def choose(
    journal: Journal,
    diagnosis: Diagnosis | None,
    *,
    menu: Menu,
    ramp: float,
    budget: Budget,
    seconds_of: Callable[[str, tuple[float, ...]], float],
) -> Choice | Ending:
    """Return the next run by the diagnosis of all before it, None: there was none, or why there is none.

    `ramp` [rad/s^2] is that of the base plan, `seconds_of` tells how long a plan takes.
    """
    wanted = _choose_run(journal, diagnosis, menu, ramp)
    if isinstance(wanted, Ending):
        return wanted
    cost = seconds_of(wanted.plan, wanted.speeds)
    if not budget.allows(runs=len(journal.judged) + 1, seconds=journal.seconds + cost):
        return Ending(f"The budget is used up: {len(journal.judged)} runs, {journal.seconds / 60:.1f} min.")
    return wanted


def _choose_run(journal: Journal, diagnosis: Diagnosis | None, menu: Menu, ramp: float) -> Choice | Ending:
    if diagnosis is None:
        return Choice(plan=menu.base, trial=(), why="The first run, by the plan that was given.")
    if diagnosis.verdict is Verdict.ADEQUATE:
        return Ending("The model of the config describes every run.")
    if diagnosis.verdict is Verdict.NAMED and all(cause.nameplate for cause in diagnosis.causes if cause.chosen):
        return Ending("A statement of the config is wrong; with what it should say, the model describes every run.")
    if diagnosis.verdict is Verdict.NAMED:
        return _choose_test(journal, menu)
    run = diagnosis.next_run
    if run is None or not run.planned:
        return Ending(run.words if run else "No run is known that would tell more.")
    if run.lam < VERDICT.worthwhile:
        return Ending("No run that this rig can make would tell them apart.")
    if run.share_of_limit > VERDICT.of_limit:
        return Ending(f"The run that would tell most may come too near a limit. {run.words}")
    plan = menu.plan_of(run, ramp)
    if not plan:
        return Ending(f"What would tell most wants other hands than this program's. {run.words}")
    if any((each.plan, each.trial, each.speeds) == (plan, run.trial, run.speeds) for each in journal.judged):
        return Ending(f"The run that would tell most has been made. {run.words}")
    told = f"It would tell apart {'; '.join(run.separates)}." if run.separates else OPEN[diagnosis.verdict]
    return Choice(plan=plan, trial=run.trial, why=f"{told} {run.words}", speeds=run.speeds)


def _choose_test(journal: Journal, menu: Menu) -> Choice | Ending:
    """Return a repetition that no fit sees; why there is none once it was made."""
    last = journal.judged[-1]
    if last.joined:
        return Ending(
            "A cause is named by all runs together. On the run that no fit had seen it gained no more than runs stray "
            "from each other."
        )
    if last.unseen:
        return Ending("A cause is named, and its gain is measured on a run that no fit has seen.")
    why = "A cause is named: a run that no fit sees measures what it gains."
    return Choice(plan=menu.base, trial=journal.mounted, why=why, unseen=True)


def not_possible(menu: Menu, *, hands: bool) -> tuple[str, ...]:
    """Return the kinds of runs that are not to be proposed; with `hands` there is somebody to mount a mass."""
    kinds = ["reverse rotation"]  # not every drive can, and an investigation does not rewire one
    kinds += [] if menu.slower and menu.faster else ["ramp rate"]
    kinds += [] if menu.held else ["dwells"]
    kinds += [] if menu.higher else ["through critical"]
    kinds += [] if hands else ["trial mass"]
    return tuple(kinds)
