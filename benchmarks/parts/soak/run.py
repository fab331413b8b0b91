"""One run of the fault campaign: a bench, the program sweeping it, a fault at a random moment, and what came of it.

Nothing is judged here: what was seen goes into a table, for judge.py.
"""

import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.parts.soak.faults import FAULTS, Ends, Fault
from benchmarks.parts.soak.rigs import config
from benchmarks.parts.soak.wire import compare
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording
from rotorrig.rig import RigError, code_version
from rotorrig.sims.wire import Message, simulated_bench
from rotorrig.sims.wire.console import Console

ROTOR = [sys.executable, "-m", "rotorrig.app.cli"]
_LIMITED = """
import resource, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # who runs the campaign's workers ignores it; inherited
resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, resource.RLIM_INFINITY))
from rotorrig.app.cli import main
main()
"""
HANGS = 120.0  # s of wall time after which a sweep hangs
_ENOUGH = 15.0  # s of wall time the bench is given beyond the rotor's time to stop
_SOON = 0.2  # s between two signals
_PRESSURE = Path("/proc/pressure/cpu")  # https://docs.kernel.org/accounting/psi.html
_FULL = (100_000, 300_000)  # bytes of a recording at which the disk is full


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One run: a drive, a fault, and its number among those."""

    drive: str
    where: str
    fault: str
    number: int

    @property
    def name(self) -> str:
        """What its file is called."""
        return f"{self.drive}, {self.where}, {self.fault}, {self.number}".replace(" ", "-").replace(",", "")

    @property
    def seed(self) -> int:
        """Draws the rig behind the wires, the moment of the fault and which bits it hits."""
        return zlib.crc32(self.name.encode())

    @property
    def what(self) -> Fault:
        """The fault itself."""
        return next(f for f in FAULTS if (f.where, f.name) == (self.where, self.fault))


def run(case: Case, *, rate: float) -> dict[str, Any]:
    """Run a case; return what was seen. Raises RigError if the bench does not start."""
    fault, rng = case.what, random.Random(case.seed)
    at = rng.uniform(*fault.window)
    largest = rng.randint(*_FULL) if fault.disk_full else None
    began, waited = time.monotonic(), _waited()
    with tempfile.TemporaryDirectory(prefix="rotorrig-soak-") as scratch:
        folder = Path(scratch)
        script, wire, out = folder / "faults.json", folder / "wire", folder / "run.mcap"
        faults = [{**fault.script, "at": f"{at:.3f} s"}] if fault.script else []
        script.write_text(json.dumps({"seed": case.seed, "faults": faults}), encoding="utf-8")
        text = config(case.drive)
        with simulated_bench(text, seed=case.seed, rate=rate, faults=script, wire=wire) as ports:
            (folder / "rig.toml").write_text(config(case.drive, motor=ports.motor, daq=ports.daq), encoding="utf-8")
            with _sweeping(folder / "rig.toml", out, largest=largest) as program:
                struck = _strike(fault, program, ports.console, at=at, rate=rate)
                code, said = _end_of(program)
            _rest(ports.console, seconds=fault.stops_within / rate + _ENOUGH)
        return {
            "case": asdict(case),
            "code_version": code_version(),
            "rate": rate,
            "crowded": (_waited() - waited) / (time.monotonic() - began),
            "at": at,
            "struck": struck,
            "code": code,
            "said": said,
            "bench": ports.console.messages,
            "files": sorted(path.name for path in folder.glob("run.mcap*")),
            **_recorded(fault, out, wire),
        }


def _sweeping(rig: Path, out: Path, *, largest: int | None) -> "subprocess.Popen[str]":
    """Start the program; no file of it may grow beyond `largest` bytes, as on a full disk."""
    begin = _LIMITED.format(size=resource.RLIM_INFINITY if largest is None else largest)
    return subprocess.Popen(
        [sys.executable, "-c", begin, "sweep", str(rig), "--out", str(out)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "COLUMNS": "2000", "PYTHONFAULTHANDLER": "1"},  # no line is broken
    )


def _strike(fault: Fault, program: "subprocess.Popen[str]", rig: Console, *, at: float, rate: float) -> Message | None:
    """Send the program its signals from rig time `at` on; return when that was, None if it gets none or had ended."""
    if not fault.signals:
        return None
    try:
        seen = rig.wait_for(lambda line: "speed" in line and line["t"] >= at - rate, timeout=HANGS)
    except RigError:
        return None
    time.sleep(max(0.0, (at - seen["t"]) / rate))
    if program.poll() is not None:
        return None
    now = rig.play([])
    for signal_name in fault.signals:
        program.send_signal(signal.Signals[signal_name])
        if signal_name == "SIGSTOP":
            _rest(rig, seconds=fault.stops_within / rate)
        else:
            time.sleep(_SOON)
    return now


def _end_of(program: "subprocess.Popen[str]") -> tuple[int | None, str]:
    """Return the exit status, None if it hung, and all it said."""
    try:
        said, _ = program.communicate(timeout=HANGS)
    except subprocess.TimeoutExpired:
        program.send_signal(signal.SIGABRT)  # it says where each of its threads is, and ends
        return None, program.communicate()[0]
    return program.returncode, said


def _rest(rig: Console, *, seconds: float) -> None:
    """Wait until the rotor is at rest, at the most for so long."""
    deadline = time.monotonic() + seconds
    while turns(rig.messages) and time.monotonic() < deadline:
        time.sleep(0.1)


def turns(said: Iterable[Message]) -> bool:
    """Return whether the rotor turns, by what the bench has said."""
    moves = [line["event"] for line in said if line.get("event") in ("turns", "rests")]
    return bool(moves) and moves[-1] == "turns"


def _waited() -> float:
    """Return for how long, of all time, some process of this machine has waited for a processor [s]; 0 if not known."""
    try:
        some = _PRESSURE.read_text(encoding="ascii").splitlines()[0]
    except OSError:  # not Linux, or an old one
        return 0.0
    return int(some.rpartition("=")[2]) * 1e-6


def _recorded(fault: Fault, out: Path, wire: Path) -> dict[str, Any]:
    """Return what became of the recording, beside what was on the DAQ's wire."""
    salvaged = ""
    if fault.ends is Ends.KILLED:
        part, out = out.with_name(f"{out.name}.part"), out.with_name("saved.mcap")
        done = subprocess.run(
            [*ROTOR, "salvage", str(part), "--out", str(out)], capture_output=True, text=True, check=False
        )
        salvaged = done.stdout + done.stderr
    try:
        recording = read_recording(out)
    except RigError as error:
        return {"salvaged": salvaged, "unreadable": str(error)}
    return {"salvaged": salvaged, "recording": _table(recording), "wire": asdict(compare(wire.read_bytes(), recording))}


def _table(recording: RawRecording) -> dict[str, Any]:
    return {
        "complete": recording.complete,
        "events": [[event.t_ns / 1e9, event.kind, event.text] for event in recording.events],
        "faults": sorted({sample.fault for sample in recording.motor if sample.fault}),
        "fastest": max((max(sample.speed, sample.setpoint) for sample in recording.motor), default=0.0),
    }
