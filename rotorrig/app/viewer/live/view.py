"""Handle of the live view for a sweep: blocks are handed over without waiting.

Tracking and drawing have a process of their own (process.py): a drawing thread here would hold the interpreter's lock
against the recorder and the interlock. What does not fit into the pipe waits here, newest kept; a view that hangs, dies
or is slow costs blocks of the picture alone.
"""

import contextlib
import logging
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Sequence
from typing import IO, Self

from rotorrig.acquisition import Event
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.live.pipe import READY, block_parts, opening
from rotorrig.app.viewer.sinks import Sink, quiet_environment
from rotorrig.rig import RigError
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo

WAITING_SAMPLES = 4_000_000  # scans that may wait; beyond, the oldest are dropped and the tracker sees a gap
START_SECONDS = 30.0  # for the libraries to load, on a busy machine
FAREWELL = 20.0  # s without progress after which a view that is to end is ended: a busy machine draws slowly

log = logging.getLogger(__name__)


class LiveView:
    """Shows a sweep while it runs. `show` never waits; tracking and drawing have a process of their own.

    Every block is tracked, so that the Bode plot is whole; only the newest state is drawn. A fault of the view stands
    in `fault` and never reaches the sweep.
    """

    def __init__(
        self,
        rig: RigConfig,
        info: DaqInfo,
        sink: Sink,
        *,
        events: Sequence[Event] | None = None,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        """Start the process and wait until it is ready to draw. Raises RigError if it does not get there.

        `events` are those of a recording that is played, shown when their time comes; None for a rig. Amplitudes are
        told in `unit`.
        """
        self.dropped = 0  # blocks that were never shown
        self.fault = ""  # why the view was given up; empty: it was not
        self.sink = sink
        self._waiting: deque[Block] = deque()
        self._samples = 0  # in _waiting
        self._handed_over = 0  # blocks: progress, while the view is ending
        self._changed = threading.Condition()
        self._ended = False
        self._process = _start_process(opening(rig, info, sink.targets, events=events, unit=unit))
        self._thread = threading.Thread(target=self._hand_over, name="live view", daemon=True)
        self._thread.start()

    @property
    def pid(self) -> int:
        """The drawing process."""
        return self._process.pid

    def show(self, block: Block) -> None:
        """Hand over a block; returns at once."""
        with self._changed:
            if self.fault:
                self.dropped += 1
                return
            self._waiting.append(block)
            self._samples += len(block.counts)
            while self._samples > WAITING_SAMPLES and len(self._waiting) > 1:
                self._samples -= len(self._waiting.popleft().counts)
                self.dropped += 1
            self._changed.notify()

    def listen(self, block: Block) -> None:
        """Hand over a block as `show` does; raises RigError once the view is lost, for a recording to say so."""
        self.show(block)
        if self.fault:
            raise RigError(f"{self.fault}, and left {self.dropped} blocks undrawn")

    def close(self) -> None:
        """Let what still waits be drawn and finish the stream; may be called twice. The viewer stays open."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        seen = -1
        while self._thread.is_alive() and seen != self._handed_over:
            seen = self._handed_over
            self._thread.join(FAREWELL)
        if self._thread.is_alive():
            self._process.kill()  # the thread's write fails, and it ends
            self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _hand_over(self) -> None:
        """Feed the process until the end, or its end, and find out how that came about."""
        assert self._process.stdin
        try:
            while (block := self._next()) is not None:
                for part in block_parts(block):
                    _write_all(self._process.stdin, part)
                self._handed_over += 1
            self._process.stdin.close()
        except OSError:  # nobody reads any more
            pass
        self._finish()

    def _next(self) -> Block | None:
        """Wait for a block; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ended)
            if not self._waiting:
                return None
            block = self._waiting.popleft()
            self._samples -= len(block.counts)
            return block

    def _finish(self) -> None:
        fault = _wait_for_end(self._process)
        with self._changed:
            self.fault = fault
            self.dropped += len(self._waiting)
            self._waiting.clear()
        if fault:
            log.warning("the live view ended: %s", fault)
        elif self.dropped:
            log.warning("the live view was too slow for %d blocks", self.dropped)


def _start_process(opening: bytes) -> subprocess.Popen[bytes]:
    """Start the drawing process, send it `opening`, return it once it is ready. Raises RigError in its own words."""
    process = subprocess.Popen(
        [sys.executable, "-m", "rotorrig.app.viewer.live.process"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        bufsize=0,
        env=quiet_environment(),
        start_new_session=True,  # Ctrl-C is for the sweep; the view ends with its input
    )
    assert process.stdin and process.stdout
    overdue = threading.Timer(START_SECONDS, process.kill)
    overdue.start()
    try:
        _write_all(process.stdin, opening)
        ready = process.stdout.readline() == READY
    except OSError:
        ready = False
    finally:
        overdue.cancel()
    if not ready:
        raise RigError(f"live view: did not start ({_wait_for_end(process)})")
    return process


def _wait_for_end(process: subprocess.Popen[bytes]) -> str:
    """Wait for the end of the process and return what went wrong, empty if nothing did."""
    assert process.stdin and process.stdout and process.stderr
    overdue = threading.Timer(FAREWELL, process.kill)
    overdue.start()
    messages = process.stderr.read().decode(errors="replace").strip().splitlines()
    process.wait()
    overdue.cancel()
    for pipe in (process.stdin, process.stdout, process.stderr):
        _close(pipe)
    if process.returncode < 0:
        return f"its process was ended by signal {-process.returncode}"
    if process.returncode:
        return messages[-1] if messages else f"its process ended with {process.returncode}"
    return ""


def _write_all(pipe: IO[bytes], data: bytes | memoryview) -> None:
    """Write to an unbuffered pipe, however little of it a signal lets through at a time. Raises OSError."""
    view = memoryview(data)
    while view:
        view = view[pipe.write(view) :]


def _close(pipe: IO[bytes]) -> None:
    with contextlib.suppress(OSError):  # of a pipe nobody reads
        pipe.close()
