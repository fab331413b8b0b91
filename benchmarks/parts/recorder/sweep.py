"""The recording process of the recorder's benchmark: sweeps with the drivers and the engine a lab would use.

`python -m benchmarks.parts.recorder.sweep JSON`, the fields of `Task`. Prints a line of JSON per sweep.
"""

import contextlib
import json
import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from benchmarks.parts.recorder.rig import SPEED
from rotorrig.acquisition.files import RecordingWriter
from rotorrig.acquisition.sweep import reading_interval, run_sweep
from rotorrig.acquisition.sweep.plans import Dwell, Mark, Ramp
from rotorrig.app.viewer.live import LiveView
from rotorrig.app.viewer.sinks import to_file
from rotorrig.rig import Interlock, Provenance, connect
from rotorrig.rig.config import RigConfig, load
from rotorrig.rig.control import GuardedControl, ask_guardian
from rotorrig.rig.probes import DaqInfo

RAMP = 1000.0  # rad/s^2: the rotor of the benchmark has no mass

Viewer = Literal["none", "attached", "hung", "killed"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What to record."""

    config: str
    motor: dict[str, Any]  # where the drive is
    daq: dict[str, Any]
    out: str  # a name per sweep is made of it
    seconds: float  # of the dwell, unless something stops it
    sweeps: int = 1
    viewer: Viewer = "none"


def record(task: Task) -> None:
    """Record the sweeps, a line of JSON about each."""
    rig = load(Path(task.config))
    with contextlib.ExitStack() as stack:
        daq = stack.enter_context(connect.daq(rig, at=task.daq))
        info = daq.open()
        view = stack.enter_context(_view(rig, info, Path(task.out))) if task.viewer != "none" else None
        for number in range(task.sweeps):
            if view and number == task.sweeps // 3:  # a third of the sweeps with a sound viewer
                _disturb(view, task.viewer)
            out = Path(task.out).with_suffix(f".{number}.mcap")
            steps = (Mark(label="up"), Ramp(to=SPEED, rate=RAMP), Mark(label="dwell"), Dwell(seconds=task.seconds))
            ask_guardian(connect.motor_table(rig, at=task.motor), "stop")  # of a process that was killed
            control = GuardedControl(
                rig, log=out.with_suffix(".txt"), at=task.motor, every=reading_interval(rig), persist=5.0
            )
            watchdog = control.open().watchdog
            wall, cpu = time.monotonic(), time.process_time()
            result = run_sweep(
                steps,
                control=control,
                daq=daq,
                rig=rig,
                writer=RecordingWriter(out, rig, info, Provenance(config_hash=rig.hash, code_version="benchmark")),
                interlock=Interlock(rig, info),
                listeners=[view.listen] if view else [],
                watchdog=watchdog,
            )
            cpu, wall = time.process_time() - cpu, time.monotonic() - wall
            said = {"out": str(out), "samples": result.samples, "gaps": result.gaps, "trip": result.trip}
            if result.trip and (times := result.stop_times):
                said |= {"decided_s": times.decided - times.received, "handed_s": times.handed - times.received}
            print(json.dumps({**said, "cpu_s": cpu, "wall_s": wall}), flush=True)
    if view:
        print(json.dumps({"viewer_dropped": view.dropped, "viewer_fault": view.fault}), flush=True)


def _view(rig: RigConfig, info: DaqInfo, out: Path) -> LiveView:
    return LiveView(rig, info, to_file(out.with_suffix(".rrd")))


def _disturb(view: LiveView, how: Viewer) -> None:
    if how == "hung":
        os.kill(view.pid, signal.SIGSTOP)
    if how == "killed":
        os.kill(view.pid, signal.SIGKILL)


if __name__ == "__main__":
    record(Task(**json.loads(sys.argv[1])))
