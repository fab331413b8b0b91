"""Which run follows a diagnosis, and when none does."""

import dataclasses
import math

import pytest

from rotorrig.identify import Diagnosis, Verdict
from rotorrig.identify.verdict.next_run.choice import NextRun
from rotorrig.investigation.budget import Budget, read_budget
from rotorrig.investigation.choice import Choice, Ending, choose, not_possible
from rotorrig.investigation.journal import Journal, Round
from rotorrig.investigation.menu import Menu
from rotorrig.rig import ConfigError

MENU = Menu(
    base="default", slower="slower", faster="faster", held="held", higher=(("to-2000", 209.0), ("to-3000", 314.0))
)
TRIAL = ("disk: 12 g mm at 90 deg",)


def made(number: int, plan: str = "default", **more: object) -> Round:
    known = {"trial": (), "why": "", "unseen": False, "seconds": 100.0, "verdict": Verdict.TIED} | more
    return Round(number=number, plan=plan, **known)  # type: ignore[arg-type]


def next_of(journal: Journal, diagnosis: Diagnosis | None, budget: Budget | None = None) -> Choice | Ending:
    return choose(
        journal, diagnosis, menu=MENU, ramp=3.0, budget=budget or Budget(), seconds_of=lambda plan, speeds: 100.0
    )


def proposing(diagnosis: Diagnosis, kind: str, **more: object) -> Diagnosis:
    run = NextRun(kind=kind, words="Do that.", separates=("bow", "runout"), **{"lam": 30.0, **more})  # type: ignore[arg-type]
    return dataclasses.replace(diagnosis, verdict=Verdict.TIED, next_run=run)


@pytest.fixture
def one_run() -> Journal:
    return Journal(config_hash="", rounds=(made(1),))


def test_the_first_run_is_the_plan_that_was_given() -> None:
    first = next_of(Journal(config_hash=""), None)
    assert isinstance(first, Choice)
    assert (first.plan, first.trial, first.unseen) == ("default", (), False)


@pytest.mark.parametrize(
    ("kind", "more", "plan", "trial"),
    [
        ("ramp rate", {"ramp": 9.0}, "faster", ()),
        ("ramp rate", {"ramp": 1.0}, "slower", ()),
        ("through critical", {"top": 210.0}, "to-2000", ()),
        ("through critical", {"top": 312.0}, "to-3000", ()),
        ("trial mass", {"trial": TRIAL}, "default", TRIAL),
        ("dwells", {"speeds": (100.0, 150.0)}, "held", ()),
    ],
)
def test_causes_that_are_tied_get_the_run_that_would_part_them(
    kind: str, more: dict[str, object], plan: str, trial: tuple[str, ...], one_run: Journal, named: Diagnosis
) -> None:
    wanted = next_of(one_run, proposing(named, kind, **more))
    assert isinstance(wanted, Choice)
    assert (wanted.plan, wanted.trial, wanted.unseen) == (plan, trial, False)
    assert wanted.speeds == more.get("speeds", ())
    assert wanted.why == "It would tell apart bow; runout. Do that."


def test_a_named_cause_is_measured_on_a_run_that_no_fit_sees_and_then_it_ends(named: Diagnosis) -> None:
    with_mass = Journal(config_hash="", rounds=(made(1), made(2, trial=TRIAL)))
    wanted = next_of(with_mass, named)
    assert isinstance(wanted, Choice)
    assert (wanted.plan, wanted.trial, wanted.unseen) == ("default", TRIAL, True), "nobody has to take the mass off"
    measured = Journal(config_hash="", rounds=(made(1), made(2, unseen=True, verdict=Verdict.NAMED)))
    assert "its gain is measured" in next_of(measured, named).why
    joined = Journal(config_hash="", rounds=(made(1), made(2, unseen=True, joined=True, verdict=Verdict.NAMED)))
    assert "no more than runs stray" in next_of(joined, named).why


def test_what_the_config_states_wrongly_is_no_cause_whose_gain_is_measured(one_run: Journal, named: Diagnosis) -> None:
    of_config = dataclasses.replace(named, causes=(dataclasses.replace(named.causes[0], nameplate=True),))
    assert "statement of the config is wrong" in next_of(one_run, of_config).why


def test_no_run_follows_where_none_tells_more(one_run: Journal, good: Diagnosis, named: Diagnosis) -> None:
    assert isinstance(next_of(one_run, good), Ending)
    assert isinstance(next_of(one_run, proposing(named, "ramp rate", ramp=9.0, lam=0.2)), Ending)
    assert isinstance(next_of(one_run, proposing(named, "none", lam=math.nan)), Ending)
    loud = next_of(one_run, proposing(named, "ramp rate", ramp=9.0, share_of_limit=0.71))
    assert isinstance(loud, Ending), "and none that may come near a limit is made"
    elsewhere = next_of(one_run, proposing(named, "second plane"))
    assert isinstance(elsewhere, Ending)
    assert elsewhere.why.endswith("Do that.")
    twice = Journal(config_hash="", rounds=(made(1), made(2, plan="faster")))
    assert isinstance(next_of(twice, proposing(named, "ramp rate", ramp=9.0)), Ending)
    held = Journal(config_hash="", rounds=(made(1), made(2, plan="held", speeds=(100.0,))))
    assert isinstance(next_of(held, proposing(named, "dwells", speeds=(100.0,))), Ending)
    assert isinstance(next_of(held, proposing(named, "dwells", speeds=(150.0,))), Choice), "at other speeds"


def test_the_budget_ends_it(one_run: Journal, named: Diagnosis) -> None:
    for budget in (Budget(runs=1), Budget(seconds=199.0)):
        over = next_of(one_run, named, budget)
        assert isinstance(over, Ending)
        assert over.why == "The budget is used up: 1 runs, 1.7 min."
    assert isinstance(next_of(one_run, named, Budget(runs=2, seconds=200.0)), Choice)


def test_without_hands_nobody_mounts_a_mass() -> None:
    assert "trial mass" in not_possible(MENU, hands=False)
    assert "trial mass" not in not_possible(MENU, hands=True)
    assert "dwells" not in not_possible(MENU, hands=False)
    assert {"ramp rate", "through critical", "dwells"} <= set(not_possible(Menu(base="steps"), hands=True))


def test_budgets_are_read() -> None:
    assert read_budget("4 runs", where="--budget") == Budget(runs=4)
    assert read_budget("1 run, 30 min", where="--budget") == Budget(runs=1, seconds=1800.0)
    assert read_budget("90 s", where="--budget") == Budget(seconds=90.0)


@pytest.mark.parametrize("text", ["", "six runs", "0 runs", "3 runs, 4 runs", "30", "-5 min", "10 mm", "1 s, 2 s"])
def test_what_is_no_budget_is_refused_in_a_sentence(text: str) -> None:
    with pytest.raises(ConfigError, match="--budget"):
        read_budget(text, where="--budget")
