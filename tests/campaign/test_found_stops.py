"""Stops that failed once, over links, terminals and programs that die: the runs of benchmarks/soak.py, in real time."""

import pytest

from benchmarks.parts.soak.cases import CASES
from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.run import run
from tests.campaign.wanted import Wanted, ended_at_rest, left, stopped, within

WANTED: dict[str, Wanted] = {
    "one supply": lambda verdict: verdict.status != 0,
    "one supply, no watchdog": left,
    "terminal and link for 4 s": lambda verdict: verdict.rpm_at_end < 30.0,
    "pipe and link for 4 s": stopped,
    "ignored stop": left,
    "ignored stop, interrupted": lambda verdict: left(verdict) or ended_at_rest(verdict),
    "ignored stop, tripped": lambda verdict: left(verdict) or ended_at_rest(verdict),
    "only coast": within(5.0),
    "only coast, plan's end": lambda verdict: verdict.stop_s is not None and not verdict.left,
    "one busy": lambda verdict: verdict.status == 0,
    "SIGQUIT": within(0.5),
    "kill -9": lambda verdict: verdict.guardian_stop_ms is not None and verdict.guardian_stop_ms <= 500.0,
}


@pytest.mark.campaign
@pytest.mark.parametrize("name", list(WANTED))
def test_a_stop_that_failed_once_does_not_fail_again(name: str) -> None:
    verdict = run(CASES[name], judge)
    assert verdict.wrong == [], verdict.last_line
    assert WANTED[name](verdict), verdict
