"""Sweeps against the peers, healthy ones and what was found once (benchmarks/soak.py): programs, in real time."""

from collections.abc import Callable

import pytest

from benchmarks.parts.soak.cases import CASES
from benchmarks.parts.soak.controllers import CONTROLLERS
from benchmarks.parts.soak.faults import Case
from benchmarks.parts.soak.judge import Verdict, judge
from benchmarks.parts.soak.run import run

ALWAYS = "acs355-tcp"  # the others in `make test-all`
Wanted = Callable[[Verdict], bool]


@pytest.mark.parametrize(
    "controller", [pytest.param(name, marks=[] if name == ALWAYS else pytest.mark.campaign) for name in CONTROLLERS]
)
def test_a_healthy_sweep_is_finished_with_the_rotor_at_rest(controller: str) -> None:
    verdict = run(Case(set="singles", controller=controller, faults=()), judge)
    assert verdict.wrong == []
    assert (verdict.status, verdict.rpm_at_end, verdict.left) == (0, 0.0, False)
    assert verdict.claims["recording"] == "rest"
    assert verdict.fastest_rpm == pytest.approx(1200.0, rel=0.01)


def stopped(verdict: Verdict) -> bool:
    """The sweep ended for the fault, with the rotor at rest, without the operator's help."""
    return verdict.status not in (0, None) and not verdict.left and verdict.stop_s is not None


def got_stop(verdict: Verdict, *, within: float) -> bool:
    """The drive got a stop so soon [s] after the last fault, and none before the first."""
    moments = verdict.faults.values()
    return verdict.first_stop_s is not None and verdict.first_stop_s + min(moments) - max(moments) <= within


def within(seconds: float) -> Wanted:
    """It was stopped so soon."""
    return lambda verdict: stopped(verdict) and got_stop(verdict, within=seconds)


def obeyed_within(seconds: float) -> Wanted:
    """Likewise; within its first turn, the rotor gave no pulse by which it could be proven at rest."""
    return lambda verdict: (
        got_stop(verdict, within=seconds) and verdict.rpm_at_end == 0.0 and (stopped(verdict) or left(verdict))
    )


def ended_at_rest(verdict: Verdict) -> bool:
    """The drive's watchdog has stopped the rotor, and the program says so, whether or not the operator wanted to go."""
    return verdict.claims.get("line") == "rest" and verdict.rpm_at_end == 0.0


def left(verdict: Verdict) -> bool:
    """The program went on until the operator left it, and did not call the rotor stopped."""
    return verdict.left and verdict.claims.get("line") == "turning"


#: what each case wants besides nothing said or done that is wrong
WANTED: dict[str, Wanted] = {
    "one supply": lambda verdict: verdict.status != 0,
    "one supply, no watchdog": left,
    "terminal and link for 4 s": lambda verdict: verdict.rpm_at_end < 30.0,
    "pipe and link for 4 s": stopped,
    "lost frames and keyphasor": within(4.0),
    "lost frames": within(15.0),
    "late samples": within(6.0),
    "ignored stop": left,
    "ignored stop, interrupted": lambda verdict: left(verdict) or ended_at_rest(verdict),
    "ignored stop, tripped": lambda verdict: left(verdict) or ended_at_rest(verdict),
    "only coast": within(5.0),
    "only coast, plan's end": lambda verdict: verdict.stop_s is not None and not verdict.left,
    "one busy": lambda verdict: verdict.status == 0,
    "SIGQUIT": within(0.5),
    "kill -9": lambda verdict: verdict.guardian_stop_ms is not None and verdict.guardian_stop_ms <= 500.0,
    "dwell at 3500 rpm": within(2.0),
    "dwell at 60 rpm": within(5.0),
    "wrong pole pairs": lambda verdict: stopped(verdict) and verdict.fastest_rpm < 600.0,
    "wrong pole pairs, dwell": lambda verdict: stopped(verdict) and verdict.fastest_rpm < 600.0,
    "rolling start": lambda verdict: verdict.status not in (0, None) and not verdict.started,
    "dead probe, 0 V": obeyed_within(10.0),
    "dead probe, -19.9 V": obeyed_within(10.0),
    "reports 0 and keyphasor": within(5.0),
}


def test_every_case_says_what_it_wants() -> None:
    assert set(WANTED) == set(CASES)


@pytest.mark.campaign
@pytest.mark.parametrize("name", list(CASES))
def test_what_was_found_once_does_not_come_back(name: str) -> None:
    verdict = run(CASES[name], judge)
    assert verdict.wrong == []
    assert WANTED[name](verdict), verdict
