"""Proof tests of drives that do not stop, or have nothing to stop by: programs, in real time."""

from pathlib import Path

import pytest

from tests.campaign.proof import PLAN_OF_TEST, peer_of, prove


@pytest.mark.campaign
def test_a_watchdog_that_does_not_bite_fails_the_certificate(tmp_path: Path) -> None:
    with peer_of("acs355-tcp", tmp_path) as peer:
        peer.switch("no watchdog")
        outcome = prove(peer, "acs355-tcp", tmp_path)
    assert outcome.status == 1
    assert "watchdog FAILED" in outcome.complaint
    assert "the rotor is at rest" in outcome.complaint
    assert not outcome.certificate["passed"]
    assert outcome.verdicts == {
        **dict.fromkeys(PLAN_OF_TEST[:4], "passed"),
        "watchdog": "failed",
        "link loss": "not tested",
    }
    assert peer.speed == 0.0


@pytest.mark.campaign
def test_a_drive_that_ignores_stops_fails_with_the_ladder_climbed(tmp_path: Path) -> None:
    with peer_of("line", tmp_path) as peer:
        peer.switch("ignores stop")
        outcome = prove(peer, "line", tmp_path)
    assert outcome.status == 1
    assert "emergency stop FAILED, the drive did not obey the stop; it took 'silence'" in outcome.complaint
    assert {event["kind"] for event in peer.events if event["event"] == "command"} >= {"run", "quick", "coast"}
    assert [event["event"] for event in peer.events if event["event"] == "watchdog"] == ["watchdog"]
    assert list(outcome.verdicts.values()) == ["failed", *["not tested"] * 5]
    assert peer.speed == 0.0


@pytest.mark.campaign
def test_a_drive_without_a_watchdog_is_certified_as_having_none(tmp_path: Path) -> None:
    with peer_of("vfd-ed-rtu", tmp_path) as peer:
        outcome = prove(peer, "vfd-ed-rtu", tmp_path)
    assert outcome.complaint == ""
    assert outcome.status == 0
    assert outcome.verdicts["watchdog"] == outcome.verdicts["link loss"] == "not available"
    assert "has no watchdog" in outcome.part("watchdog")["why"]
