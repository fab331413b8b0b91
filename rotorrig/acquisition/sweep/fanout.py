"""Recorder and viewers of a sweep, each on a thread of its own.

The recorder gets every item, and its failure stops the sweep; viewers get the newest block, and theirs does not.
"""

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

QUEUE_DEPTH = 1000  # items that may wait for the disk: 20 s of 20 ms blocks
PUT_TIMEOUT = 1.0  # s to wait for room in the queue before giving up: the interlock waits with it
FLUSH_AFTER = 0.1  # s without an item after which a chunk that is not full is flushed
CLOSE_TIMEOUT = 2.0  # s for a viewer to finish its last block


class _Pause(Enum):
    """Marker for a pause in which no item came."""

    PAUSE = auto()


class Writer(Protocol):
    """Recording file as the recorder uses it."""

    def write_block(self, block: Block) -> None:
        """Add a block."""
        ...

    def write_event(self, event: Event) -> None:
        """Add an event."""
        ...

    def write_motor(self, sample: MotorSample) -> None:
        """Add a reading of the motor controller."""
        ...

    def flush(self) -> None:
        """Hand what was added to the operating system, so that it outlives this process."""
        ...

    def close(self) -> None:
        """Finish the file; may be called twice."""
        ...


class Recorder:
    """Thread that writes every item, in order; in a pause it flushes."""

    def __init__(self, writer: Writer, *, depth: int = QUEUE_DEPTH, patience: float = PUT_TIMEOUT) -> None:
        self._writer = writer
        self._patience = patience
        self._queue: queue.Queue[Item | _Pause | None] = queue.Queue(depth)
        self._fault: Exception | None = None
        self._flushed = True  # nothing waits for the rest of its chunk
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
                f"recorder: {self._queue.maxsize} blocks and readings wait to be written and none was for "
                f"{self._patience:g} s, want a disk that keeps up"
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
        while (item := self._next_item()) is not None:
            if self._fault is not None:
                continue  # nothing more can be written, but nobody should wait for room in the queue
            try:
                self._write(item)
            except Exception as fault:  # raised by `put`, whose thread stops the rotor
                self._fault = fault

    def _next_item(self) -> Item | _Pause | None:
        """Wait for the next item; in a pause return PAUSE, once. None at the end."""
        try:
            item = self._queue.get(timeout=None if self._flushed else FLUSH_AFTER)
        except queue.Empty:
            item = _Pause.PAUSE
        self._flushed = item is _Pause.PAUSE
        return item

    def _write(self, item: Item | _Pause) -> None:
        match item:
            case _Pause.PAUSE:
                self._writer.flush()
            case Block():
                self._writer.write_block(item)
            case Event():
                self._writer.write_event(item)
            case MotorSample():
                self._writer.write_motor(item)


class Viewer:
    """Thread that shows the newest block to one listener; blocks it has no time for are dropped."""

    def __init__(self, listener: Listener) -> None:
        self.dropped = 0  # blocks the listener never saw
        self.fault = ""  # why the listener failed; empty: it did not
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
        self._thread.join(CLOSE_TIMEOUT)

    def _show_all(self) -> None:
        while (block := self._next_block()) is not None:
            try:
                self._listener(block)
            except Exception as fault:  # a picture is not worth a sweep; the engine notes it in the recording
                self.fault = f"{type(fault).__name__}: {fault}"
                return

    def _next_block(self) -> Block | None:
        """Wait for the next block; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None or self._ended)
            block, self._newest = self._newest, None
            return block
