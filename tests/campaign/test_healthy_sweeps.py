"""Healthy sweeps against the peers: programs, in real time."""

import pytest

from benchmarks.parts.soak.controllers import CONTROLLERS
from benchmarks.parts.soak.faults import Case
from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.run import run


@pytest.mark.campaign
@pytest.mark.parametrize("controller", CONTROLLERS)
def test_a_healthy_sweep_is_finished_with_the_rotor_at_rest(controller: str) -> None:
    verdict = run(Case(set="singles", controller=controller, faults=()), judge)
    assert verdict.wrong == [], verdict.last_line
    assert (verdict.status, verdict.rpm_at_end, verdict.left) == (0, 0.0, False)
    assert verdict.claims["recording"] == "rest"
    assert verdict.fastest_rpm == pytest.approx(1200.0, rel=0.01)
