"""`RawRecording`: everything a sweep recorded, as raw counts with their calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import Provenance
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Event during a recording: a mark of the plan, a trip, a gap. See docs/sweeps.md."""

    t_ns: int  # sample clock
    kind: str  # "mark", "trial", "pause", "gap", "overrun", "note", or an ending: "stop", "abort", "trip", "emergency"
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorSample:
    """Reading of the motor controller, at the sample clock's time of asking."""

    t_ns: int
    speed: float  # rad/s
    setpoint: float  # rad/s
    running: bool
    fault: str


class Counts(Protocol):
    """Raw counts (sample, channel) of a stretch without a gap, in memory or in a file: slices of it are arrays."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Samples and channels."""

    def __len__(self) -> int: ...

    def __getitem__(self, samples: slice, /) -> NDArray[np.int32]: ...


class WaveformSource(Protocol):
    """Recording as a source of waveforms, in memory or in its file."""

    @property
    def rig(self) -> RigConfig:
        """Config of the rig it was made on."""

    @property
    def daq(self) -> DaqInfo:
        """DAQ and scale of the counts."""

    @property
    def events(self) -> tuple[Event, ...]:
        """Marks of the plan, trial masses, trips."""

    @property
    def source(self) -> Provenance:
        """Origin: file, config and code version."""

    def segments(self) -> Sequence[tuple[int, Counts]]:
        """Return gap-free stretches as (first sample, counts (sample, channel))."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RawRecording:
    """Counts with their calibration; volts and metres are made on reading, see rig.probes.calibration."""

    rig: RigConfig
    daq: DaqInfo
    blocks: tuple[Block, ...]  # in order; gaps visible in first_sample
    events: tuple[Event, ...]
    motor: tuple[MotorSample, ...]
    source: Provenance
    complete: bool  # False: the file was cut and this is what could be saved

    @property
    def samples(self) -> int:
        """Number of scans present (gaps not counted)."""
        return sum(len(block.counts) for block in self.blocks)

    def segments(self) -> list[tuple[int, NDArray[np.int32]]]:
        """Return gap-free stretches as (first_sample, counts (sample, channel))."""
        runs: list[list[Block]] = []
        for block in self.blocks:
            if runs and block.first_sample == runs[-1][-1].first_sample + len(runs[-1][-1].counts):
                runs[-1].append(block)
            else:
                runs.append([block])
        return [(run[0].first_sample, _join([block.counts for block in run])) for run in runs]


def _join(parts: list[NDArray[np.int32]]) -> NDArray[np.int32]:
    """Concatenate counts (sample, channel); parts that lie side by side in one array are not copied."""
    whole, first = parts[0].base, parts[0]
    if isinstance(whole, np.ndarray) and whole.dtype == first.dtype and whole.shape[1:] == first.shape[1:]:
        begin = (_address(first) - _address(whole)) // max(whole.strides[0], 1)
        joined = whole[begin : begin + sum(map(len, parts))]
        at = _address(joined)
        for part in parts:
            if part.base is not whole or part.strides != joined.strides or _address(part) != at:
                break
            at += part.nbytes
        else:
            return joined
    return np.concatenate(parts)


def _address(array: NDArray[np.int32]) -> int:
    return int(array.ctypes.data)
