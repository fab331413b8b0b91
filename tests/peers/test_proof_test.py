"""A proof test of peers: what it certifies, against the true speed that their journal has."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.parts.soak.controllers import ROOT, config
from benchmarks.parts.soak.peer import Peer

SLOW_ROLL = 300.0  # rpm, of the campaign's plan
AT_REST = 1.0  # rpm
TURN = 0.2  # s
LAG = 0.15  # s: a block and the way to the program, and the journal's steps of the true speed
WATCHDOG = 2.0  # s
PLAN_OF_TEST = ("emergency stop", "overspeed", "keyphasor loss", "guardian", "watchdog", "link loss")
BUSY = {"guardian": "2 s"}  # of [motor]: a machine that runs other tests besides is not to be taken for a hang


@dataclass
class Outcome:
    """What `rotor check --proof-test` certified, said and returned."""

    status: int
    certificate: dict[str, Any]
    complaint: str

    def part(self, name: str) -> dict[str, Any]:
        return next(part for part in self.certificate["protections"] if part["name"] == name)

    @property
    def verdicts(self) -> dict[str, str]:
        return {part["name"]: part["verdict"] for part in self.certificate["protections"]}


@contextmanager
def peer_of(controller: str, folder: Path) -> Iterator[Peer]:
    peer = Peer(controller, folder, root=ROOT, seed=1, rate=5000.0, rolling=0.0)
    try:
        yield peer
    finally:
        peer.close()


def prove(peer: Peer, controller: str, folder: Path) -> Outcome:
    path = folder / "rig.toml"
    path.write_text(config(controller, peer.ports, **BUSY), encoding="utf-8")
    command = [sys.executable, "-m", "rotorrig.app.cli", "check", str(path), "--proof-test", "--yes"]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=400,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"},
    )
    peer.follow()
    assert (folder / "rig.proof.json").is_file(), done.stderr
    certificate = json.loads((folder / "rig.proof.json").read_text())
    return Outcome(done.returncode, certificate, done.stderr.strip().split("\n")[-1])


def true_stops(peer: Peer) -> list[tuple[float, float]]:
    """When the rotor became slower than 98 % of its speed and when it came to rest, for every time it turned."""
    t, rpm = np.array(peer.t), np.array(peer.rpm)
    change = np.diff((rpm > AT_REST).astype(int))
    stops = []
    for first, last in zip(np.flatnonzero(change == 1), np.flatnonzero(change == -1), strict=True):
        fast = np.flatnonzero(rpm[first : last + 1] >= 0.98 * SLOW_ROLL)
        stops.append((t[first + fast[-1]], t[last]))
    return stops


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
