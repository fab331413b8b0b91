"""What every DAQ offers, and the one thing it hands on: `Block`, raw counts with their place in time."""

from dataclasses import dataclass
from types import TracebackType
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class DaqInfo:
    """What a DAQ says of itself when opened; with it, counts become volts: volts = counts * volts_per_count."""

    model: str
    serial: str
    sample_rate: float  # Hz
    channels: int
    volts_per_count: tuple[float, ...]  # per channel
    full_scale_counts: int  # counts run from -full_scale to full_scale - 1; at either end the input is clipped


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Consecutive scans of all channels, as the ADC gave them.

    A gap between blocks shows as `first_sample` jumping ahead; it is counted, never filled.
    """

    counts: NDArray[np.int32]  # (sample, channel)
    first_sample: int  # index since the stream began
    t_ns: int  # time of the first sample on the sample clock, ns since the stream began
    overrun: bool = False  # the DAQ lost samples just before this block


class Daq(Protocol):
    """A DAQ's verbs. `open` before the rest; a context manager closes what it opened."""

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
