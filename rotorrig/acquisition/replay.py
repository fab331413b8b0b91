"""A recording behaving as a live DAQ: what works on a rig can be tried on a file."""

import math
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

from rotorrig.acquisition.mcap_file import read_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.clock import Clock, WallClock
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.base import Block, DaqInfo


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

    @property
    def ended(self) -> bool:
        """Whether the last block has been played."""
        return self._next is not None and self._next >= len(self.recording.blocks)

    def open(self) -> DaqInfo:
        """Return what the recorded DAQ said of itself."""
        return self.recording.daq

    def start(self) -> None:
        """Begin, or begin again, at the first block."""
        self._next, self._began = 0, self._clock.now()

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
        """Return how far into the recording a block is complete, which is when a DAQ would hand it over."""
        if index < 0:
            return 0.0
        first, block = self.recording.blocks[0], self.recording.blocks[index]
        return (block.t_ns - first.t_ns) / 1e9 + len(block.counts) / self.recording.daq.sample_rate
