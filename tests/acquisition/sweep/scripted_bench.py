"""A scripted rig, the file its sweep goes to, and an operator with a script."""

import signal
from collections.abc import Callable
from pathlib import Path

from rotorrig.acquisition.files.recording_mcap import RecordingWriter, read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.acquisition.sweep.engine import SweepResult, run_sweep
from rotorrig.acquisition.sweep.plans import Coast, Dwell, Mark, Ramp, Step
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.control import DirectControl
from rotorrig.rig.errors import LinkLost
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance
from tests.acquisition.sweep.scripted_rig import ScriptedDaq, ScriptedMotor, Shaft
from tests.manual_clock import ManualClock

LOOKED = 25_000  # samples taken before the first command
PLAN: tuple[Step, ...] = (
    Mark(label="slow roll"),
    Ramp(to=60.0, rate=60.0),
    Dwell(seconds=1.0),
    Mark(label="up"),
    Ramp(to=120.0, rate=30.0),
    Mark(label="down"),
    Coast(until=60.0),
    Mark(label="end"),
)


PATIENCE = 200.0  # s that anybody waits at this rig


class PatientClock(ManualClock):
    """A clock by which the operator presses Ctrl-C again and again, once patience is over."""

    def sleep(self, seconds: float) -> None:
        super().sleep(seconds)
        if self.now() > PATIENCE:
            signal.raise_signal(signal.SIGINT)


class Bench:
    """A scripted rig and the file its sweep goes to."""

    def __init__(self, rig: RigConfig, info: DaqInfo, source: Provenance, path: Path, shaft: Shaft) -> None:
        self.clock = PatientClock()
        self.shaft = shaft
        self.motor = ScriptedMotor(shaft)
        self.daq = ScriptedDaq(rig, info, shaft, self.clock)
        self.rig, self.info, self.path = rig, info, path
        self.writer = RecordingWriter(path, rig, info, source)

    def sweep(self, steps: tuple[Step, ...] = PLAN, **more: object) -> SweepResult:
        given = {"clock": self.clock, "control": DirectControl(self.motor, clock=self.clock), **more}
        return run_sweep(
            steps,
            daq=self.daq,
            rig=self.rig,
            writer=self.writer,
            interlock=Interlock(self.rig, self.info),
            **given,  # type: ignore[arg-type]
        )

    def recorded(self) -> RawRecording:
        return read_recording(self.path)

    def marks(self, kind: str = "mark") -> list[str]:
        return [event.text for event in self.recorded().events if event.kind == kind]


MakeBench = Callable[..., Bench]


class Watching:
    """An operator: wants to stop, or answers, once something is so; keeps what was said."""

    def __init__(self, *, stop: Callable[[], bool] = lambda: False, answer: Callable[[], bool] = lambda: True) -> None:
        self.asked: list[str] = []
        self.told: list[str] = []
        self._stop, self._answer = stop, answer

    def wants_stop(self) -> bool:
        return self._stop()

    def ask(self, request: str) -> None:
        self.asked.append(request)

    def has_answered(self) -> bool:
        return self._answer()

    def tell(self, text: str) -> None:
        self.told.append(text)


def at_sample(limit: int, error: BaseException) -> Callable[[Block], Block]:
    """Return a script that raises once the stream has come to sample `limit`."""

    def script(block: Block) -> Block:
        if block.first_sample >= limit:
            raise error
        return block

    return script


def gone() -> DaqInfo:
    """Open a DAQ that is not there any more."""
    raise LinkLost("DAQ: no such port")
