"""Hands a sweep's data on: the recorder gets everything and may stop the sweep, viewers get the newest and may not."""

import queue
import threading
from collections.abc import Callable
from enum import Enum, auto
from typing import Protocol

from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.rig import DataError
from rotorrig.rig.probes import Block

Item = Block | Event | MotorSample
Listener = Callable[[Block], None]

DEPTH = 1000  # items that may wait for the disk: 20 s of 20 ms blocks
PATIENCE = 1.0  # s to wait for room among them before giving up: the interlock waits with it
IDLE = 0.1  # s without anything to write after which what waits for the rest of its chunk is handed to the system
FAREWELL = 2.0  # s for a viewer to finish its last block


class _Pause(Enum):
    """Stands for a while in which nothing came."""

    PAUSE = auto()


class Writer(Protocol):
    """What the recorder needs of a recording's file."""

    def block(self, block: Block) -> None:
        """Add a block."""
        ...

    def event(self, event: Event) -> None:
        """Add an event."""
        ...

    def motor(self, sample: MotorSample) -> None:
        """Add a reading of the motor controller."""
        ...

    def flush(self) -> None:
        """Hand what was added to the system, so that it outlives this process."""
        ...

    def close(self) -> None:
        """Finish the file; may be called twice."""
        ...


class Recorder:
    """Writes all it is given, in order, on a thread of its own; in a pause, nothing of it is held back."""

    def __init__(self, writer: Writer, *, depth: int = DEPTH, patience: float = PATIENCE) -> None:
        self._writer = writer
        self._patience = patience
        self._queue: queue.Queue[Item | _Pause | None] = queue.Queue(depth)
        self._fault: Exception | None = None
        self._paused = True  # nothing is held back
        self._thread = threading.Thread(target=self._write_all, name="recorder", daemon=True)
        self._thread.start()

    def put(self, item: Item) -> None:
        """Hand over one item. Raises what the writer raised on an earlier one, DataError if the disk is too slow."""
        if self._fault is not None:
            raise self._fault
        try:
            self._queue.put(item, timeout=self._patience)
        except queue.Full:
            raise DataError(
                f"recorder: {self._queue.maxsize} blocks and readings wait to be written and for {self._patience:g} s "
                "none was, want a disk that keeps up"
            ) from None

    def close(self) -> None:
        """Write what still waits and close the file; may be called twice. Raises what the writer raised."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join()
        self._writer.close()
        if self._fault is not None:
            raise self._fault

    def _write_all(self) -> None:
        while (item := self._next()) is not None:
            if self._fault is not None:
                continue  # nothing more can be written, but nobody shall wait for room in the queue
            try:
                self._write(item)
            except Exception as fault:  # handed to the thread that puts, which stops the rotor
                self._fault = fault

    def _next(self) -> Item | _Pause | None:
        """Wait for the next item; once, when none has come for a while, return a pause instead. None at the end."""
        try:
            item = self._queue.get(timeout=None if self._paused else IDLE)
        except queue.Empty:
            item = _Pause.PAUSE
        self._paused = item is _Pause.PAUSE
        return item

    def _write(self, item: Item | _Pause) -> None:
        match item:
            case _Pause.PAUSE:
                self._writer.flush()
            case Block():
                self._writer.block(item)
            case Event():
                self._writer.event(item)
            case MotorSample():
                self._writer.motor(item)


class Viewer:
    """Shows the newest block to one listener, on a thread of its own; those it has no time for are dropped."""

    def __init__(self, listener: Listener) -> None:
        self.dropped = 0  # blocks the listener never saw
        self.fault = ""  # why it was given up; empty: it was not
        self._listener = listener
        self._newest: Block | None = None
        self._ended = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._show_all, name="viewer", daemon=True)
        self._thread.start()

    def show(self, block: Block) -> None:
        """Offer a block; returns at once."""
        with self._changed:
            self.dropped += self._newest is not None or bool(self.fault)
            self._newest = None if self.fault else block
            self._changed.notify()

    def close(self) -> None:
        """Let the listener finish the block it has, for two seconds at most; may be called twice."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._thread.join(FAREWELL)

    def _show_all(self) -> None:
        while (block := self._next()) is not None:
            try:
                self._listener(block)
            except Exception as fault:  # a picture is not worth a sweep; the engine notes it in the recording
                self.fault = f"{type(fault).__name__}: {fault}"
                return

    def _next(self) -> Block | None:
        """Wait for the next block; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None or self._ended)
            block, self._newest = self._newest, None
            return block
