"""The steps of one recording: track, identify, diagnose, report, each writing its file whole.

A step whose file an earlier computation has made, with the same input, config and code version, is not done again. What
follows is always computed from the file as it is read back, so that a computation that was broken off and one that was
not come to the same numbers. Seeds come from the recording's hash; no step is limited by time.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import Any

from rotorrig.acquisition import Event
from rotorrig.acquisition.files import open_recording
from rotorrig.app.commands.diagnose import with_model_of
from rotorrig.app.lab.page import write_bode_data
from rotorrig.app.lab.recordings import Recording, find_recordings
from rotorrig.app.lab.settings import STEPS, LabSettings
from rotorrig.app.lab.storage import Lab
from rotorrig.app.report import write_report
from rotorrig.identify import (
    Diagnosis,
    Identification,
    diagnose,
    identify,
    read_diagnosis,
    read_identification,
    write_diagnosis,
    write_identification,
)
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.processing.files import read_response, write_response
from rotorrig.rig import DataError, code_version, file_hash

FILES = {"track": "response.mcap", "identify": "fit.json", "diagnose": "diagnosis.json", "report": "report.html"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A recording to work through, and how."""

    lab: Lab
    recording: Recording
    settings: LabSettings
    code_version: str

    @property
    def key(self) -> str:
        """Key of the computation."""
        return self.settings.key(self.recording.run_id, code_version=self.code_version)

    @property
    def seed(self) -> int:
        """Seed of every search: the same for a recording, whatever the config and the version."""
        return int(self.recording.run_id[:8], 16)

    def keys_with(self, step: str) -> Iterator[str]:
        """Yield the keys under which this step may have been done already: its own first."""
        yield self.key
        others = [s for s in STEPS[1:] if s != step]
        must = dict.fromkeys(("track", step))
        settings = (self.settings, LabSettings()) if step == "track" else (self.settings,)  # tracking needs no model
        for chosen in settings:
            for number in range(len(others) + 1):
                for some in combinations(others, number):
                    steps = [s for s in STEPS if s in must or s in some]
                    yield chosen.key(self.recording.run_id, code_version=self.code_version, steps=steps)


def find_jobs(
    folder: Path, settings: LabSettings, *, progress: Callable[[int, int], None] = lambda done, of: None
) -> list[Job]:
    """Return a job for every recording of a folder, done or not. Raises DataError if it cannot be read or written."""
    lab, version = Lab.of(folder), code_version()
    recordings = find_recordings(lab, progress=progress)
    if recordings:
        lab.make_folders()
    return [Job(lab=lab, recording=each, settings=settings, code_version=version) for each in recordings]


@dataclass(slots=True, kw_only=True)
class Outcome:
    """What the steps of a recording have come to so far."""

    step: str = ""  # the last that was done
    sentence: str = ""  # of a failure
    response: OrderTrackedResponse | None = None
    identification: Identification | None = None
    diagnosis: Diagnosis | None = None
    events: tuple[Event, ...] = ()
    recorded_s: float | None = None  # duration of a recording's samples
    files: dict[str, Path] = field(default_factory=dict)  # step -> its file
    seconds: dict[str, float] = field(default_factory=dict)  # step -> how long it took; without those taken over


def do_steps(job: Job, outcome: Outcome) -> None:
    """Do the steps asked for, writing into `outcome` as they end. Raises DataError, ConfigError."""
    for step in job.settings.steps:
        path = _earlier_file(job, step)
        if path is None:
            path = job.lab.results(job.recording.run_id, job.key) / FILES[step]
            path.parent.mkdir(parents=True, exist_ok=True)
            began = time.perf_counter()
            _MAKE[step](job, path, outcome)
            outcome.seconds[step] = time.perf_counter() - began
        outcome.files[step] = path
        _READ[step](job, path, outcome)
        if step == "track":
            _keep_curves(job, _response(outcome))
        outcome.step = step


def _earlier_file(job: Job, step: str) -> Path | None:
    """Return the file of a step that was done before; a response of the tree is its own. A report is made anew."""
    if step == "track" and job.recording.kind == "response":
        return job.lab.root / job.recording.file
    if step == "report":
        return None
    paths = (job.lab.results(job.recording.run_id, key) / FILES[step] for key in job.keys_with(step))
    return next((path for path in paths if path.is_file()), None)


def _make_response(job: Job, path: Path, outcome: Outcome) -> None:
    with open_recording(job.lab.root / job.recording.file) as recording:
        write_response(path, track(recording))


def _read_response(job: Job, path: Path, outcome: Outcome) -> None:
    source = job.lab.root / job.recording.file
    if file_hash(source) != job.recording.run_id:
        raise DataError(f"{source}: has changed since the lab looked at it; run the lab again")
    if job.recording.kind == "run":
        with open_recording(source) as recording:
            outcome.events = recording.events
            outcome.recorded_s = recording.samples / recording.daq.sample_rate
    response = read_response(path)
    rig = job.settings.config
    if rig and rig.nameplate_hash not in (response.rig.nameplate_hash, response.rig.turned_over.nameplate_hash):
        raise DataError(
            f"{job.recording.file}: is from another rig ({response.rig.name}, {response.rig.nameplate_hash}) than the "
            f"config given ({rig.name}, {rig.nameplate_hash}), want recordings of one rig"
        )
    outcome.response = with_model_of(response, rig) if rig else response


def _keep_curves(job: Job, response: OrderTrackedResponse) -> None:
    """Write what a page of the lab shows of a response while it is at hand: pages need not read it again."""
    if 1.0 not in response.orders:
        return
    path = job.lab.curves(job.recording.run_id, job.key)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bode_data(path, job.recording.run_id, response)


def _make_fit(job: Job, path: Path, outcome: Outcome) -> None:
    write_identification(path, identify([_response(outcome)], seed=job.seed))


def _read_fit(job: Job, path: Path, outcome: Outcome) -> None:
    outcome.identification = read_identification(path)


def _make_diagnosis(job: Job, path: Path, outcome: Outcome) -> None:
    write_diagnosis(path, diagnose([_response(outcome)], seed=job.seed))


def _read_diagnosis(job: Job, path: Path, outcome: Outcome) -> None:
    outcome.diagnosis = read_diagnosis(path)


def _make_report(job: Job, path: Path, outcome: Outcome) -> None:
    write_report(
        path,
        response=_response(outcome),
        identification=outcome.identification,
        diagnosis=outcome.diagnosis,
    )


def _response(outcome: Outcome) -> OrderTrackedResponse:
    assert outcome.response is not None, "every other step comes behind track"
    return outcome.response


_MAKE: dict[str, Any] = {
    "track": _make_response,
    "identify": _make_fit,
    "diagnose": _make_diagnosis,
    "report": _make_report,
}
_READ: dict[str, Any] = {
    "track": _read_response,
    "identify": _read_fit,
    "diagnose": _read_diagnosis,
    "report": lambda job, path, outcome: None,
}
