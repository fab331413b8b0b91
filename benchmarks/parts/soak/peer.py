"""The peer bench of a run: its process, its events, its rotor's true speed."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import psutil

Event = dict[str, Any]


class Peer:
    """A `tests.peers.bench` in a process of its own."""

    def __init__(self, controller: str, folder: Path, *, root: Path, seed: int, rate: float, rolling: float) -> None:
        """Start it and wait for its ports."""
        self.ports: dict[str, Any]
        self.events: list[Event] = []
        self.t: list[float] = []  # s monotonic, and the true speed then
        self.rpm: list[float] = []
        self.on: list[bool] = []
        self.wire = folder / "wire"
        self._journal = folder / "journal.jsonl"
        self._read = 0
        command = [sys.executable, "-m", "tests.peers.bench", controller, str(folder)]
        self._process = subprocess.Popen(
            [*command, "--seed", str(seed), "--rate", str(rate), "--rolling", str(rolling)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=root,
            env={**os.environ, "PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1"},
        )
        assert self._process.stdout is not None
        first = self._process.stdout.readline()
        if not first:
            raise RuntimeError(f"the peer bench of {controller} did not start")
        while "motor" not in (said := json.loads(first)):
            first = self._process.stdout.readline()
        self.ports = said

    def switch(self, name: str, *, value: Any = None, seconds: float | None = None) -> None:
        """Switch a fault on."""
        assert self._process.stdin is not None
        asked = {"switch": name, "value": value, "seconds": seconds}
        self._process.stdin.write(json.dumps({k: v for k, v in asked.items() if v is not None}) + "\n")
        self._process.stdin.flush()

    def follow(self) -> None:
        """Take what the journal says since the last call."""
        with self._journal.open("rb") as file:
            file.seek(self._read)
            for line in file:
                if not line.endswith(b"\n"):
                    break
                self._read += len(line)
                said = json.loads(line)
                if "event" in said:
                    self.events.append(said)
                else:
                    self.t.append(said["t"])
                    self.rpm.append(said["rpm"])
                    self.on.append(said["on"])

    @property
    def speed(self) -> float:
        """True speed at the last line, rpm."""
        return self.rpm[-1] if self.rpm else 0.0

    def speed_at(self, t: float) -> float:
        """Return the true speed at a time of the machine's monotonic clock, rpm."""
        return float(np.interp(t, self.t, self.rpm)) if self.t else 0.0

    def first(self, event: str, *, after: float = 0.0) -> Event | None:
        """Return the first event of a kind after a time."""
        return next((e for e in self.events if e["event"] == event and e["t"] >= after), None)

    def first_stop(self, *, after: float) -> Event | None:
        """Return the first command to stop after a time, of a drive that is on."""
        commands = (e for e in self.events if e["event"] == "command" and e["t"] >= after)
        return next((e for e in commands if e["kind"] != "run" and e["on"]), None)

    @property
    def cpu(self) -> float:
        """Processor time so far, s."""
        times = psutil.Process(self._process.pid).cpu_times()
        return times.user + times.system

    def close(self) -> None:
        """End it."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self.follow()
