"""The figures of one run of the recorder benchmark."""

import os
from dataclasses import dataclass, field

import numpy as np


@dataclass(kw_only=True)
class Report:
    """What was measured."""

    cores: int = field(default_factory=lambda: os.cpu_count() or 1)
    load: float = float("nan")  # programs at work at a time: the mean of the last quarter of an hour
    minutes: float = 0.0
    cpu_share: float = float("nan")  # of one core: DAQ reader, session, motor control, recorder
    samples: int = 0  # per channel
    samples_lost: int = 0
    file_bytes: int = 0
    compression: float = float("nan")  # of the file to its int16 samples
    read_s: float = float("nan")  # to read the long recording
    read_rss: float = float("nan")  # bytes of memory that takes
    trips_ms: dict[str, list[float]] = field(default_factory=dict)  # by viewer
    missed_trips: int = 0
    decided_ms: list[float] = field(default_factory=list)  # from a block's receipt by the sweep to the decision
    handed_ms: list[float] = field(default_factory=list)  # ... to the driver's being told
    kills_lost_s: list[float] = field(default_factory=list)
    kills_bad: int = 0  # salvaged files that were wrong

    def summary(self) -> dict[str, float | None]:
        """Return the figures that are promised; None for one that was not measured."""
        trips = [ms for found in self.trips_ms.values() for ms in found]
        lost = self.kills_lost_s
        return {
            "cpu_share": round(self.cpu_share, 4) if self.samples else None,
            "samples_lost": self.samples_lost if self.samples else None,
            "trip_ms_p99": round(float(np.percentile(trips, 99)), 2) if trips else None,
            "trips_missed": self.missed_trips,
            "salvage_lost_s_max": round(max(lost), 4) if lost else None,
            "salvage_bad": self.kills_bad,
            "compression": round(self.compression, 4) if self.samples else None,
        }
