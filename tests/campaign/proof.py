"""A proof test of a peer: how it is run, and what the journal has of the true speed."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

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
