"""Gap voltage: a probe whose mean leaves its linear range is not OK, and after a delay stops the rotor.

API 670 asks a monitor to find a transducer circuit that is open, shorted or out of its range. There a not-OK channel
alarms and is taken out of the vote. Here it trips: a rig has few probes and no vote, and what a dead probe would have
seen nobody sees.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.rig.errors import LimitExceeded

NOT_OK_SECONDS = 1.0  # without a break; a block's mean swings with the vibration, but at 60 rpm and above never as long


class GapVoltage:
    """Counts for every probe how long its mean voltage has been outside the range in which the probe is OK."""

    def __init__(self, rig: RigConfig) -> None:
        self._names = [probe.name for probe in rig.probes]
        ranges = [sorted(probe.linear_range) for probe in rig.probes]
        fits = [low < probe.gap_voltage < high for probe, (low, high) in zip(rig.probes, ranges, strict=True)]
        self._low = np.array([low if ok else -math.inf for ok, (low, _) in zip(fits, ranges, strict=True)])
        self._high = np.array([high if ok else math.inf for ok, (_, high) in zip(fits, ranges, strict=True)])
        self._outside = np.zeros(len(rig.probes))  # (probe,) s

    def check(self, volts: NDArray[np.float64], *, seconds: float) -> None:
        """Take each probe's mean [V] over a block of so many seconds. Raises LimitExceeded."""
        bad = (volts < self._low) | (volts > self._high)
        if not bad.any():
            self._outside[:] = 0.0
            return
        self._outside = np.where(bad, self._outside + seconds, 0.0)
        i = int(self._outside.argmax())
        if self._outside[i] >= NOT_OK_SECONDS:
            raise LimitExceeded(
                f"probe {self._names[i]}: not OK, gap voltage {volts[i]:.1f} V for {self._outside[i]:.1f} s, "
                f"want {self._low[i]:g} to {self._high[i]:g} V; check its gap and cable"
            )
