"""Counts of an NI device: its own where they are proportional to volts, else linearised by its calibration.

An NI device gives raw integers and a polynomial, volts = c0 + c1 raw + c2 raw^2 + c3 raw^3, from its calibration (NI,
"Is DAQmx Raw Data Calibrated and/or Scaled?": M and X series have four coefficients, E series two with c0 = 0). Counts
here are volts over volts_per_count, so a polynomial that is more than a slope has to be applied. It is, in steps of a
sixteenth of a raw count: no raw value is lost, each can be found again from its count.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FINER = 16  # counts per raw count where a polynomial is applied
NEGLIGIBLE = 0.01  # raw counts by which a polynomial may differ from its slope and pass for it
MOST = 1 << 30  # counts; beyond, the steps are those of the raw counts


@dataclass(frozen=True, slots=True, kw_only=True)
class Linearisation:
    """Conversion of the raw integers of one input to counts."""

    coefficients: tuple[float, ...]  # V, rising powers of a raw count
    volts_per_count: float  # > 0
    is_raw: bool  # handed on as they are
    lowest: int  # counts at the ends of the input's range
    highest: int

    @property
    def remark(self) -> str:
        """Description of the counts, for a person."""
        if self.is_raw:
            return f"raw counts of {self.volts_per_count * 1e6:.4g} uV"
        return (
            "raw counts linearised by the device's calibration polynomial, "
            f"in steps of {self.volts_per_count * 1e6:.4g} uV"
        )

    def counts(self, raw: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return counts (sample,) from raw integers (sample,)."""
        if self.is_raw:
            return raw
        volts = np.polynomial.polynomial.polyval(raw.astype(np.float64), self.coefficients)
        return np.rint(volts / self.volts_per_count).astype(np.int32)


def linearise(coefficients: tuple[float, ...], *, low: float, high: float) -> Linearisation:
    """Return the conversion of an input whose range is `low` to `high` [V]. Raises ValueError on a slope of zero.

    >>> linearise((0.0, 20 / 65536), low=-10.0, high=10.0).is_raw
    True
    >>> linearise((0.001, 20 / 65536, 0.0, 0.0), low=-10.0, high=10.0).is_raw
    False
    """
    slope = coefficients[1] if len(coefficients) > 1 else 0.0
    if not np.isfinite(coefficients).all() or slope == 0:
        raise ValueError(f"got the scaling coefficients {coefficients}, want a slope that is not zero")
    reach = np.linspace(low, high, 65) / slope  # raw counts over the range
    others = (coefficients[0], 0.0, *coefficients[2:])
    is_raw = slope > 0 and bool((np.abs(np.polynomial.polynomial.polyval(reach, others)) < NEGLIGIBLE * slope).all())
    widest = float(np.abs(reach).max())
    step = abs(slope) if is_raw or widest * FINER > MOST else abs(slope) / FINER
    return Linearisation(
        coefficients=coefficients,
        volts_per_count=step,
        is_raw=is_raw,
        lowest=int(np.ceil(low / step)),
        highest=int(np.floor(high / step)) - (high == -low and is_raw),  # two's complement has one less above zero
    )
