"""Rerun views: a sweep as it runs, a file opened afterwards, and a run or its result as an .rrd file."""

import tempfile
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import open_recording, read_recording
from rotorrig.app.terminal import working
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.live import LiveView, open_stream
from rotorrig.app.viewer.live.data import history_of, split_into_steps
from rotorrig.app.viewer.live.parts import LiveScene
from rotorrig.app.viewer.result import TIMELINE, read_opening, write_result_rrd
from rotorrig.app.viewer.sinks import Sink, serve, show_files, to_file
from rotorrig.balancing import read_balance
from rotorrig.identify import read_diagnosis, read_identification
from rotorrig.processing import OrderTrackedResponse, require_phases
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError, provisional_file

__all__ = ["LiveView", "Sink", "serve", "to_file", "view_file", "write_recording_rrd", "write_result_rrd"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """The files that belong to a response.mcap and are shown with it."""

    fit: Path | None = None  # fit.json: the model
    diagnosis: Path | None = None  # diagnosis.json: verdict, residual, the extended model
    balance: Path | None = None  # balance.json: corrections, vectors before and after
    run: Path | None = None  # run.mcap: orbits and spectra as recorded
    unit: AmplitudeUnit = AS_STATED  # in which amplitudes are told

    @property
    def given(self) -> bool:
        """True if there is any."""
        return bool(self.fit or self.diagnosis or self.balance or self.run)


ALONE = Evidence()


def view_file(path: Path, evidence: Evidence = ALONE, *, headless: bool | None = None) -> None:
    """Open run.mcap, response.mcap or an .rrd in the Rerun viewer; returns when that is closed.

    A window opens a result at its largest misfit; in a web page nothing can move the cursor, and it plays on.

    Raises DataError for a file of another kind, or evidence that is not of it; RigError if the viewer does not start.
    """
    with tempfile.TemporaryDirectory(prefix="rotor-view-") as folder:
        with working(f"drawing {path.name}"):
            made = as_rrd(path, Path(folder), evidence)
        rpm = read_opening(made)
        with show_files([made], cursor=None if rpm is None else (TIMELINE, rpm), headless=headless) as viewer:
            viewer.wait()


def save_view(path: Path, out: Path, evidence: Evidence = ALONE) -> None:
    """Write the picture of a run.mcap, or of a response.mcap and what belongs to it, to `out`, an .rrd.

    Raises DataError, RigError.
    """
    if out.suffix != ".rrd":
        raise DataError(f"{out}: ends in '{out.suffix}', want a name that ends in .rrd")
    with working(f"drawing {path.name}"):
        _draw(path, out, evidence)


def as_rrd(path: Path, folder: Path, evidence: Evidence = ALONE) -> Path:
    """Return `path` if it is an .rrd, else its picture written into `folder`. Raises DataError."""
    if path.suffix != ".rrd" or evidence.given:
        made = folder / f"{path.stem}.rrd"
        _draw(path, made, evidence)
        return made
    if not path.is_file():
        raise DataError(f"{path}: there is no such file, want an .rrd, run.mcap or response.mcap")
    if evidence.unit != AS_STATED:
        raise DataError(f"{path}: is drawn already, want the run.mcap or response.mcap to draw it in other units")
    return path


def _draw(path: Path, out: Path, evidence: Evidence) -> None:
    """Write the picture of a response, or of a recording if it is one and nothing else belongs to it."""
    try:
        response = read_response(path)
    except DataError as not_a_response:
        if evidence.given:
            raise
        try:
            recording = read_recording(path)
        except DataError as not_a_run:
            # the file says what it is: the complaint about its own kind is the useful one
            raise (not_a_run if "run" in path.name else not_a_response) from None
        write_recording_rrd(out, recording, unit=evidence.unit)
    else:
        _write_result(out, response, evidence)


def _write_result(out: Path, response: OrderTrackedResponse, evidence: Evidence) -> None:
    require_phases([response], "the view of a response")
    identification = read_identification(evidence.fit) if evidence.fit else None
    diagnosis = read_diagnosis(evidence.diagnosis) if evidence.diagnosis else None
    balance = read_balance(evidence.balance) if evidence.balance else None
    with open_recording(evidence.run) if evidence.run else nullcontext() as recording:
        write_result_rrd(out, response, identification, diagnosis, recording, balance, unit=evidence.unit)


def write_recording_rrd(path: Path, recording: RawRecording, *, unit: AmplitudeUnit = AS_STATED) -> None:
    """Write an .rrd of a recording: its curves whole, at every time the orbit and the readings of that time.

    Amplitudes are told in `unit`. Raises DataError if the file cannot be written, RigError.
    """
    with provisional_file(path) as made:
        stream = open_stream(recording.rig, "replay", to_file(made).targets)
        whole = history_of(recording)
        scene = LiveScene(recording.rig, recording.daq, stream, events=recording.events, whole=whole, unit=unit)
        for block in split_into_steps(recording):
            scene.take(block)
            scene.draw()
        scene.draw(last=True)
        stream.disconnect()
