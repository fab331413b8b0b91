"""Rerun views: a sweep as it runs, a file opened afterwards, and the result of a run as an .rrd file."""

import logging
import tempfile
import threading
import time
from collections import deque
from pathlib import Path
from typing import Self

import numpy as np
import rerun as rr

from rotorrig.acquisition.mcap_file import read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.blueprint import live_blueprint
from rotorrig.app.live_scene import LiveScene
from rotorrig.app.result_view import write_result_rrd
from rotorrig.app.sinks import Sink, serve, show_files, to_file
from rotorrig.processing.response_file import read_response
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import DataError, RigError
from rotorrig.rig.probes.base import Block, DaqInfo

__all__ = ["LiveView", "Sink", "serve", "to_file", "view_file", "write_recording_rrd", "write_result_rrd"]

FRAME = 0.12  # s of wall time between pictures
WAITING_SAMPLES = 4_000_000  # scans that may wait; beyond, the oldest are dropped and the tracker sees a gap
REPLAY_FRAME = 0.25  # s of the recording between pictures of a recording shown afterwards
FAREWELL = 5.0  # s for the last picture

log = logging.getLogger(__name__)


class LiveView:
    """Shows a sweep while it runs. `show` never waits; tracking and drawing have a thread of their own.

    Every block is tracked, so that the Bode plot is whole; only the newest state is drawn. A fault in here ends the
    view and stands in `fault`; it never reaches the sweep.
    """

    def __init__(self, rig: RigConfig, info: DaqInfo, sink: Sink) -> None:
        self.dropped = 0  # blocks that could not wait for the tracker
        self.fault = ""  # why the view was given up; empty: it was not
        self.sink = sink
        self._stream = _stream(rig, "live", sink)
        self._scene = LiveScene(rig, info, self._stream)
        self._waiting: deque[Block] = deque()
        self._samples = 0  # in _waiting
        self._changed = threading.Condition()
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="live view", daemon=True)
        self._thread.start()

    def show(self, block: Block) -> None:
        """Hand over a block; returns at once."""
        with self._changed:
            if self.fault:
                return
            self._waiting.append(block)
            self._samples += len(block.counts)
            while self._samples > WAITING_SAMPLES and len(self._waiting) > 1:
                self._samples -= len(self._waiting.popleft().counts)
                self.dropped += 1
            self._changed.notify()

    def close(self) -> None:
        """Draw what still waits and finish the stream; may be called twice. The viewer stays open."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._thread.join(FAREWELL)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _run(self) -> None:
        try:
            while (blocks := self._take()) is not None:
                began = time.monotonic()
                for block in joined(blocks):
                    self._scene.take(block)
                self._scene.draw()
                self._pause(FRAME - (time.monotonic() - began))
            self._scene.draw(last=True)
            self._stream.disconnect()
        except Exception as error:  # a picture is not worth a sweep
            self.fault = f"{type(error).__name__}: {error}"
            log.warning("the live view ended: %s", self.fault)

    def _take(self) -> list[Block] | None:
        """Wait for blocks and return all there are; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ended)
            blocks = list(self._waiting)
            self._waiting.clear()
            self._samples = 0
            return blocks or None

    def _pause(self, seconds: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._ended, timeout=max(seconds, 0.0))


def joined(blocks: list[Block]) -> list[Block]:
    """Return the blocks with those that follow on each other put together: tracking pays per call."""
    runs: list[list[Block]] = []
    for block in blocks:
        last = runs[-1][-1] if runs else None
        if last is not None and block.first_sample == last.first_sample + len(last.counts):
            runs[-1].append(block)
        else:
            runs.append([block])
    return [
        Block(counts=np.concatenate([b.counts for b in run]), first_sample=run[0].first_sample, t_ns=run[0].t_ns)
        for run in runs
    ]


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
    stream = _stream(recording.rig, "replay", to_file(path))
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


def _stream(rig: RigConfig, kind: str, sink: Sink) -> rr.RecordingStream:
    if not sink.targets:
        raise RigError("live view: the sink has nowhere to write to, want one of serve() or to_file()")
    stream = rr.RecordingStream("rotorrig run", recording_id=f"{kind}-{time.time_ns():x}")
    stream.set_sinks(*sink.targets, default_blueprint=live_blueprint(rig))
    stream.send_recording_name(f"{rig.name}, {kind}")
    return stream
