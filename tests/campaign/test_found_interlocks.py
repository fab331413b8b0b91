"""What once ran on untripped: the runs of benchmarks/soak.py, in real time."""

import pytest

from benchmarks.parts.soak.cases import CASES
from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.run import run
from tests.campaign.test_found_stops import WANTED as STOPS
from tests.campaign.wanted import Wanted, obeyed_within, stopped, within

WANTED: dict[str, Wanted] = {
    "lost frames and keyphasor": within(4.0),
    "lost frames": within(15.0),
    "late samples": within(6.0),
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
    assert WANTED.keys() | STOPS.keys() == CASES.keys()


@pytest.mark.campaign
@pytest.mark.parametrize("name", list(WANTED))
def test_what_ran_on_untripped_once_does_not_again(name: str) -> None:
    verdict = run(CASES[name], judge)
    assert verdict.wrong == [], verdict.last_line
    assert WANTED[name](verdict), verdict
