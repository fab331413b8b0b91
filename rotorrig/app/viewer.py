"""Rerun views: a sweep as it runs, a file opened afterwards, and the result of a run as an .rrd file."""

import tempfile
from pathlib import Path

from rotorrig.acquisition.mcap_file import read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.live_process import open_stream
from rotorrig.app.live_scene import LiveScene
from rotorrig.app.live_view import LiveView
from rotorrig.app.result_view import write_result_rrd
from rotorrig.app.sinks import Sink, serve, show_files, to_file
from rotorrig.processing.response_file import read_response
from rotorrig.rig.errors import DataError
from rotorrig.rig.probes.base import Block

__all__ = ["LiveView", "Sink", "serve", "to_file", "view_file", "write_recording_rrd", "write_result_rrd"]

REPLAY_FRAME = 0.25  # s of the recording between pictures of a recording shown afterwards


def view_file(path: Path, *, headless: bool | None = None) -> None:
    """Open run.mcap, response.mcap or an .rrd in the Rerun viewer; returns when that is closed.

    Raises DataError for a file of another kind, RigError if the viewer does not start.
    """
    with (
        tempfile.TemporaryDirectory(prefix="rotor-view-") as folder,
        show_files([as_rrd(path, Path(folder))], headless=headless) as viewer,
    ):
        viewer.wait()


def as_rrd(path: Path, folder: Path) -> Path:
    """Return `path` if it is an .rrd, else its picture written into `folder`. Raises DataError."""
    if path.suffix == ".rrd":
        if not path.is_file():
            raise DataError(f"{path}: there is no such file, want an .rrd, run.mcap or response.mcap")
        return path
    made = folder / f"{path.stem}.rrd"
    try:
        response = read_response(path)
    except DataError as not_a_response:
        try:
            recording = read_recording(path)
        except DataError as not_a_run:
            # the file says what it is: the complaint about its own kind is the useful one
            raise (not_a_run if "run" in path.name else not_a_response) from None
        write_recording_rrd(made, recording)
    else:
        write_result_rrd(made, response)
    return made


def write_recording_rrd(path: Path, recording: RawRecording) -> None:
    """Write an .rrd that shows a recording as it would have looked live. Raises RigError."""
    stream = open_stream(recording.rig, "replay", to_file(path).targets)
    scene = LiveScene(recording.rig, recording.daq, stream)
    step = max(1, round(REPLAY_FRAME * recording.daq.sample_rate))
    for first, counts in recording.segments():
        for begin in range(0, len(counts), step):
            at = first + begin
            t_ns = round(at * 1e9 / recording.daq.sample_rate)
            scene.take(Block(counts=counts[begin : begin + step], first_sample=at, t_ns=t_ns))
            scene.draw()
    scene.draw(last=True)
    stream.disconnect()
