import threading
import time

import numpy as np
import pytest

from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.acquisition.sweep.fanout import FLUSH_AFTER, Recorder, Viewer
from rotorrig.rig.errors import DataError
from rotorrig.rig.probes.base import Block


def block(number: int) -> Block:
    return Block(counts=np.zeros((1, 1), dtype=np.int32), first_sample=number, t_ns=number)


class ListWriter:
    """Keeps what it is given; waits for `gate` before each item and fails at number `fails_at`."""

    def __init__(self, *, fails_at: int | None = None, gate: threading.Event | None = None) -> None:
        self.items: list[Block | Event | MotorSample] = []
        self.closed = 0
        self.flushed: list[int] = []  # how many items there were each time
        self.pause = threading.Event()
        self._fails_at, self._gate = fails_at, gate

    def write_block(self, item: Block | Event | MotorSample) -> None:
        if self._gate:
            self._gate.wait(10)
        if len(self.items) == self._fails_at:
            raise DataError("disk is full")
        self.items.append(item)

    write_event = write_motor = write_block

    def flush(self) -> None:
        self.flushed.append(len(self.items))
        self.pause.set()

    def close(self) -> None:
        self.closed += 1


def test_recorder_writes_everything_in_order() -> None:
    writer = ListWriter()
    recorder = Recorder(writer)
    items: list[Block | Event | MotorSample] = [
        block(0),
        Event(t_ns=1, kind="mark", text="up"),
        MotorSample(t_ns=2, speed=0.0, setpoint=0.0, running=False, fault=""),
        *(block(n) for n in range(3, 500)),
    ]
    for item in items:
        recorder.put(item)
    recorder.close()
    assert writer.items == items
    assert writer.closed


def test_a_writers_fault_is_raised_by_a_later_put_and_by_close() -> None:
    writer = ListWriter(fails_at=3)
    recorder = Recorder(writer, depth=4)
    with pytest.raises(DataError, match="disk is full"):
        for n in range(10_000):  # also: a queue nobody empties would block here
            recorder.put(block(n))
    with pytest.raises(DataError, match="disk is full"):
        recorder.close()
    assert writer.closed
    assert len(writer.items) == 3


def test_a_disk_that_does_not_keep_up_is_an_error_not_a_lost_block() -> None:
    gate = threading.Event()
    writer = ListWriter(gate=gate)
    recorder = Recorder(writer, depth=5, patience=0.05)
    with pytest.raises(DataError, match="5 blocks and readings wait"):
        for n in range(10):
            recorder.put(block(n))
    gate.set()
    recorder.close()
    assert [b.first_sample for b in writer.items if isinstance(b, Block)] == [0, 1, 2, 3, 4, 5]


def test_what_waits_in_a_pause_is_handed_on_once() -> None:
    writer = ListWriter()
    recorder = Recorder(writer)
    for n in range(3):
        recorder.put(block(n))
    assert writer.pause.wait(10)
    time.sleep(3 * FLUSH_AFTER)
    assert writer.flushed == [3]
    writer.pause.clear()
    recorder.put(block(3))
    assert writer.pause.wait(10)
    recorder.close()
    assert writer.flushed == [3, 4]


def test_a_slow_viewer_gets_the_newest_block_and_never_blocks() -> None:
    busy, go = threading.Event(), threading.Event()
    seen: list[int] = []

    def listener(shown: Block) -> None:
        seen.append(shown.first_sample)
        busy.set()
        go.wait(10)

    viewer = Viewer(listener)
    viewer.show(block(0))
    assert busy.wait(10)
    for n in range(1, 100):
        viewer.show(block(n))
    go.set()
    viewer.close()
    assert seen == [0, 99]
    assert viewer.dropped == 98


def test_a_viewer_that_fails_is_given_up_and_says_why() -> None:
    failed = threading.Event()

    def listener(shown: Block) -> None:
        failed.set()
        raise RuntimeError("no display")

    viewer = Viewer(listener)
    viewer.show(block(0))
    assert failed.wait(10)
    viewer.close()
    viewer.show(block(1))
    assert viewer.fault == "RuntimeError: no display"
    assert viewer.dropped == 1
