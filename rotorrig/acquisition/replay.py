"""Replay of a recording as a live DAQ: what works on a rig can be tried on a file.

The rate of replay changes when data come, not what comes: blocks as they were recorded, gaps and overruns included,
and events and motor readings in their places between them.
"""

import math
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

from rotorrig.acquisition.files import read_recording
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.rig import Clock, ConfigError, LinkLost, WallClock
from rotorrig.rig.probes import Block, DaqInfo

BORDERS = ("mark", "stop", "abort", "emergency", "trip", "pause")  # events that begin or end a run


class ReplayDaq:
    """A `Daq` that plays a recording's blocks, gaps and all; `start` begins at the first."""

    def __init__(
        self, recording: RawRecording | Path, *, rate: float | Literal["max"] = "max", clock: Clock | None = None
    ) -> None:
        """Play `recording`, or the file of that name, at `rate` recorded seconds per second of `clock`.

        Raises DataError if the file cannot be read, ConfigError if the rate is not above 0.
        """
        self.recording = read_recording(recording) if isinstance(recording, Path) else recording
        self._rate = math.inf if rate == "max" else rate
        if not self._rate > 0:
            raise ConfigError(f"rate: got {rate}, want 'max' or a number above 0")
        self._clock = clock or WallClock()
        self._next: int | None = None  # None: not started
        self._began = 0.0
        self._notes = _in_order(self.recording)
        self._notes_returned = 0  # how many of them

    @property
    def ended(self) -> bool:
        """True once the last block has been played."""
        return self._next is not None and self._next >= len(self.recording.blocks)

    def open(self) -> DaqInfo:
        """Return what the recorded DAQ said of itself."""
        return self.recording.daq

    def start(self) -> None:
        """Begin, or begin again, at the first block."""
        self._next, self._began, self._notes_returned = 0, self._clock.now(), 0

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block when it is due. Raises LinkLost at the end, or if it is not due within `timeout`."""
        if self._next is None:
            raise LinkLost("replay: is not started, nothing will come")
        if self.ended:
            raise LinkLost(f"replay: the recording of {self._seconds(self._next - 1):.1f} s has come to its end")
        wait = self._began + self._seconds(self._next) / self._rate - self._clock.now()
        if wait > timeout:
            self._clock.sleep(timeout)
            raise LinkLost(f"replay: silent for {timeout:g} s, the recording has a gap there")
        if wait > 0:
            self._clock.sleep(wait)
        self._next += 1
        return self.recording.blocks[self._next - 1]

    def notes(self) -> tuple[Event | MotorSample, ...]:
        """Return events and motor readings up to the end of the block last read that were not returned yet, in order.

        After the last block, all that are left.
        """
        if self._next is None or not self._next:
            return ()
        until = math.inf if self.ended else _end_ns(self.recording, self._next - 1)
        begin = end = self._notes_returned
        while end < len(self._notes) and self._notes[end].t_ns <= until:
            end += 1
        self._notes_returned = end
        return self._notes[begin:end]

    def stop(self) -> None:
        """End the stream; may be called twice."""
        self._next = None

    def close(self) -> None:
        """End the stream; may be called twice."""
        self.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _seconds(self, index: int) -> float:
        """Return when a block is complete, in seconds from the recording's start: when a DAQ would hand it over."""
        if index < 0:
            return 0.0
        first, block = self.recording.blocks[0], self.recording.blocks[index]
        return (block.t_ns - first.t_ns) / 1e9 + len(block.counts) / self.recording.daq.sample_rate


def trim_before(recording: RawRecording, seconds: float) -> RawRecording:
    """Return a recording without what came before `seconds` on its clock; indices and times stay as they are.

    Of the events before, trial masses are kept, moved to the cut, and the last that began or ended a run: it says
    which run is under way. Raises ConfigError if nothing would be left or `seconds` is no time.
    """
    if not 0 <= seconds < math.inf:
        raise ConfigError(f"from: got {seconds:g} s, want 0 or later")
    rate = recording.daq.sample_rate
    first = math.ceil(seconds * rate)
    blocks = [_tail(block, first, rate) for block in recording.blocks if block.first_sample + len(block.counts) > first]
    if not blocks:
        raise ConfigError(
            f"from: got {seconds:g} s, want less than the recording's {_end_ns(recording, -1) / 1e9:.1f} s"
        )
    cut_ns = round(first * 1e9 / rate)
    before = [event for event in recording.events if event.t_ns < cut_ns]
    border = [event for event in before if event.kind in BORDERS][-1:]
    carried = [event for event in before if event.kind == "trial"] + border
    return replace(
        recording,
        blocks=tuple(blocks),
        events=(
            *(replace(event, t_ns=cut_ns) for event in carried),
            *(event for event in recording.events if event.t_ns >= cut_ns),
        ),
        motor=tuple(sample for sample in recording.motor if sample.t_ns >= cut_ns),
    )


def _tail(block: Block, first: int, rate: float) -> Block:
    """Return the block from sample `first` on."""
    skipped = first - block.first_sample
    if skipped <= 0:
        return block
    return replace(
        block,
        counts=block.counts[skipped:],
        first_sample=first,
        t_ns=block.t_ns + round(skipped * 1e9 / rate),
        overrun=False,
    )


def _in_order(recording: RawRecording) -> tuple[Event | MotorSample, ...]:
    """Return events and motor readings by time; at the same moment events first, as a sweep writes them."""
    return tuple(sorted((*recording.events, *recording.motor), key=lambda note: note.t_ns))


def _end_ns(recording: RawRecording, index: int) -> int:
    """Return the end of a block on the sample clock [ns]."""
    block = recording.blocks[index]
    return block.t_ns + round(len(block.counts) * 1e9 / recording.daq.sample_rate)
