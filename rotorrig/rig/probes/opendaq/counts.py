"""Counts of an openDAQ channel: the converter's own where it gives them, else its volts in steps of 24 bits.

A signal with a linear post scaling carries raw integers, volts = raw * scale + offset; the offset must go, as counts
here are volts over volts_per_count: they are counted from the raw value nearest to 0 V. A signal without it carries
volts as floating point; they are rounded to a 2^23rd of the range, about what a float32 resolves near its end.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FULL_SCALE = 1 << 23
INT32 = np.iinfo(np.int32)


@dataclass(frozen=True, slots=True, kw_only=True)
class CountScale:
    """Conversion of a channel's values to counts."""

    volts_per_count: float  # > 0
    lowest: int  # counts at the ends of the range
    highest: int
    remark: str  # for a person
    gain: float  # counts per value: 1 or -1 for integers
    zero: int  # raw value that is count 0

    @property
    def full_scale(self) -> int:
        """The larger end of the range: of a unipolar input the upper one."""
        return max(-self.lowest, self.highest + 1)

    def counts(self, values: NDArray[np.generic]) -> NDArray[np.int32]:
        """Return counts (sample,) from a packet's values; what is no number becomes the lowest count, so it is seen."""
        if np.issubdtype(values.dtype, np.integer):
            exact = (values.astype(np.int64) - self.zero) * int(self.gain)
            return np.clip(exact, INT32.min, INT32.max).astype(np.int32)
        steps = np.rint(values.astype(np.float64) * self.gain)
        steps = np.nan_to_num(steps, nan=self.lowest, posinf=self.highest, neginf=self.lowest)
        return np.clip(steps, -FULL_SCALE, FULL_SCALE - 1).astype(np.int32)


def raw_scale(
    raw: np.dtype[np.integer], *, scale: float, offset: float, volts: tuple[float, float] | None
) -> CountScale:
    """Return the scale of raw integers, volts = raw * scale + offset, whose range is `volts`, if it is said.

    >>> raw_scale(np.dtype("int32"), scale=20 / 2**24, offset=-10.0, volts=(-10.0, 10.0)).zero
    8388608
    """
    zero = round(-offset / scale)
    left = offset + zero * scale  # V at count 0
    ends = np.iinfo(raw)
    if volts is not None:
        by_volts = sorted(round((v - offset) / scale) for v in volts)
        low, high = max(ends.min, by_volts[0]), min(ends.max, by_volts[1])
    else:
        low, high = int(ends.min), int(ends.max)
    lowest, highest = sorted(((low - zero) * (1 if scale > 0 else -1), (high - zero) * (1 if scale > 0 else -1)))
    moved = "" if abs(left) < 1e-6 * abs(scale) else f", {left * 1e6:.3g} uV are left out"
    return CountScale(
        volts_per_count=abs(scale),
        lowest=lowest,
        highest=highest - 1 if volts is not None and highest == -lowest else highest,
        remark=f"raw counts of {abs(scale) * 1e6:.4g} uV{moved}",
        gain=1.0 if scale > 0 else -1.0,
        zero=zero,
    )


def rounded_scale(*, volts: tuple[float, float]) -> CountScale:
    """Return the scale of volts in floating point that run over the range `volts`.

    >>> rounded_scale(volts=(-10.0, 5.0)).highest
    4194304
    """
    step = max(map(abs, volts)) / FULL_SCALE
    return CountScale(
        volts_per_count=step,
        lowest=round(volts[0] / step),
        highest=min(round(volts[1] / step), FULL_SCALE - 1),
        remark=f"the device gives volts, not counts; they are rounded to steps of {step * 1e6:.4g} uV",
        gain=1 / step,
        zero=0,
    )
