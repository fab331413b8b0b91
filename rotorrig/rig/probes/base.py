"""Interface of every DAQ: its verbs, `Block` of raw counts with its place in time, counters of lost data."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

CLOCK_TOLERANCE = 1e-3  # of a sample rate; quartz keeps 1e-4, a ceramic resonator may miss this


@dataclass(frozen=True, slots=True, kw_only=True)
class DaqInfo:
    """Identity and scaling of a DAQ, read when it is opened: volts = counts * volts_per_count."""

    model: str
    serial: str
    sample_rate: float  # Hz
    channels: int
    volts_per_count: tuple[float, ...]  # per channel
    full_scale_counts: int  # counts run from -full_scale to full_scale - 1; at either end the input is clipped
    simulated: bool = False  # its sample clock is no real one, so it is not compared with the host's
    remarks: tuple[str, ...] = ()  # what a user should know of these counts: range, wiring, how they were made

    @property
    def full_scale_volts(self) -> tuple[float, ...]:
        """Range of each input, V, either side of zero."""
        return tuple(self.full_scale_counts * abs(volts) for volts in self.volts_per_count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Consecutive scans of all channels, as the ADC gave them.

    A gap between blocks shows as `first_sample` jumping ahead; it is counted, never filled.
    """

    counts: NDArray[np.int32]  # (sample, channel)
    first_sample: int  # index since the stream began
    t_ns: int  # time of the first sample on the sample clock, ns since the stream began
    overrun: bool = False  # the DAQ lost samples just before this block


@dataclass(frozen=True, slots=True, kw_only=True)
class DaqCounters:
    """Data received and lost since `start`; only `blocks`, `samples`, `clock_error` move on a sound link.

    Samples are counted per channel: one scan of all channels counts once.
    """

    blocks: int = 0
    samples: int = 0  # handed on
    gaps: int = 0  # jumps of the sample index
    lost_samples: int = 0  # in those gaps
    overruns: int = 0  # times the device said it had lost samples
    lost_frames: int = 0  # by their sequence numbers
    damaged_frames: int = 0
    repeated_frames: int = 0  # came twice; the second is dropped
    late_frames: int = 0  # came after a later one, so their place was given up as a gap; dropped
    stray_bytes: int = 0  # part of no frame
    saturated: tuple[int, ...] = ()  # samples at an end of the range, per channel
    clock_error: float | None = None  # sample clock over the host's, relative, less 1; None: not known well enough

    def remarks(self, names: Mapping[int, str]) -> tuple[str, ...]:
        """Return a sentence for each kind of loss; saturation for the channels in `names` alone."""
        counted = (
            (self.lost_samples, f"{self.lost_samples} samples are missing in {_times(self.gaps, 'gap')}"),
            (self.overruns, f"the DAQ said {_times(self.overruns, 'time')} that it had lost samples"),
            (self.lost_frames, f"{_times(self.lost_frames, 'frame')} of the DAQ did not arrive"),
            (self.damaged_frames, f"{_times(self.damaged_frames, 'frame')} of the DAQ arrived damaged"),
            (self.repeated_frames, f"{_times(self.repeated_frames, 'frame')} of the DAQ came twice"),
            (
                self.late_frames,
                f"{_times(self.late_frames, 'frame')} of the DAQ came out of order, too late for their place",
            ),
            (self.stray_bytes, f"{_times(self.stray_bytes, 'byte')} from the DAQ were part of no sound frame"),
        )
        remarks = [sentence for count, sentence in counted if count]
        remarks += [
            f"{names[channel]} (channel {channel}): {_times(count, 'sample')} at the end of the DAQ's range"
            for channel, count in enumerate(self.saturated)
            if count and channel in names
        ]
        return (*remarks, *self._clock_remark())

    def _clock_remark(self) -> tuple[str, ...]:
        if self.clock_error is None or abs(self.clock_error) <= CLOCK_TOLERANCE:
            return ()
        return (
            f"the DAQ's sample clock runs {abs(self.clock_error):.2%} {'fast' if self.clock_error > 0 else 'slow'} "
            f"by this computer's clock, want within {CLOCK_TOLERANCE:.2%}: speeds are off by as much",
        )


class Daq(Protocol):
    """A DAQ's verbs. `open` before the rest; a context manager closes what it opened."""

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost since `start`, up to the last block read; kept after `stop` and `close`."""
        ...

    def open(self) -> DaqInfo:
        """Open the port and ask the device what it is. Raises LinkLost if nothing or something else answers."""
        ...

    def start(self) -> None:
        """Begin to stream."""
        ...

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block. Raises LinkLost after `timeout` seconds of silence."""
        ...

    def stop(self) -> None:
        """End the stream; may be called twice."""
        ...

    def close(self) -> None:
        """Give the port back; may be called twice."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def _times(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
