"""Proof tests that are passed, against the true speed that the peers' journals have: programs, in real time."""

from itertools import pairwise
from pathlib import Path

import pytest

from tests.campaign.proof import LAG, PLAN_OF_TEST, TURN, WATCHDOG, peer_of, prove, true_stops


@pytest.mark.campaign
@pytest.mark.parametrize("controller", ["acs355-tcp", "canopen", "line", "powerflex400-rtu", "m-max-rtu"])
def test_a_sound_rig_is_certified_with_the_times_of_the_true_speed(controller: str, tmp_path: Path) -> None:
    with peer_of(controller, tmp_path) as peer:
        outcome = prove(peer, controller, tmp_path)
    assert outcome.complaint == ""
    assert (outcome.status, outcome.certificate["passed"]) == (0, True)
    assert outcome.verdicts == dict.fromkeys(PLAN_OF_TEST, "passed")
    stops = true_stops(peer)
    assert len(stops) == len(PLAN_OF_TEST)
    for name, (slower, rest) in zip(PLAN_OF_TEST, stops, strict=True):
        part = outcome.part(name)
        took = part["rest_after_s"] - part["slowing_after_s"]
        assert took == pytest.approx(rest - slower, abs=2 * TURN + LAG), name
        if part["decided_after_s"] is not None:
            told = peer.first_stop(after=slower - part["slowing_after_s"] - LAG)
            assert told
            seen = part["slowing_after_s"] - part["decided_after_s"]
            assert slower - told["t"] - LAG <= seen <= slower - told["t"] + 2 * TURN + LAG, name
    bites = [event["t"] for event in peer.events if event["event"] == "watchdog"]
    again = [t for before, t in pairwise(bites) if t - before < 2 * WATCHDOG]  # some do, as long as nothing is said
    assert len(bites) - len(again) == 2
    for name in ("watchdog", "link loss"):
        assert WATCHDOG - 0.5 <= outcome.part(name)["slowing_after_s"] <= WATCHDOG + 2 * TURN + 0.5
