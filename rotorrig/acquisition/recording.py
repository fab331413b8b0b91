"""`RawRecording`: everything a sweep left behind, raw, with what is needed to make metres of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something that happened during a recording: a mark of the plan, a trip, a gap."""

    t_ns: int  # sample clock
    kind: str  # "mark", "trial", "trip", "gap", "overrun", "stop", "note"
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorSample:
    """What the motor controller reported, at the sample clock's time of asking."""

    t_ns: int
    speed: float  # rad/s
    setpoint: float  # rad/s
    running: bool
    fault: str


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
        return [(run[0].first_sample, np.concatenate([b.counts for b in run])) for run in runs]
