"""Blocks in their place in time, with gaps, lost and saturated samples counted: for every driver."""

import time
from collections import Counter

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from rotorrig.rig.probes.clock_comparison import ClockComparison


class Tally:
    """The count of one stream, from its `start` on.

    `lowest`, `highest`: counts per channel at which an input is at the end of its range, where they are not those of
    `info.full_scale_counts`.
    """

    def __init__(
        self, info: DaqInfo, *, lowest: NDArray[np.int32] | None = None, highest: NDArray[np.int32] | None = None
    ) -> None:
        self.next_sample = 0  # the one that should come next
        self._rate = info.sample_rate
        self._lowest = np.array(-info.full_scale_counts if lowest is None else lowest)
        self._highest = np.array(info.full_scale_counts - 1 if highest is None else highest)
        self._inner = int(self._lowest.max()), int(self._highest.min())  # between them no channel is at an end
        self._saturated = np.zeros(info.channels, dtype=np.int64)
        self._clock = None if info.simulated else ClockComparison(info.sample_rate)
        self._counted: Counter[str] = Counter()  # by the names of DaqCounters

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost so far."""
        return DaqCounters(
            **self._counted,
            saturated=tuple(map(int, self._saturated)),
            clock_error=self._clock.error if self._clock else None,
        )

    def block(
        self, counts: NDArray[np.int32], *, first_sample: int, overrun: bool = False, arrived: float | None = None
    ) -> Block:
        """Return counts (sample, channel) as the Block that begins at `first_sample`, which must not lie behind.

        `arrived`: when the last of them came, s of time.monotonic(); None: now.
        """
        missing = first_sample - self.next_sample
        assert missing >= 0, f"sample {first_sample} after {self.next_sample}"
        self.next_sample = first_sample + len(counts)
        self.count(blocks=1, samples=len(counts), gaps=int(missing > 0), lost_samples=missing, overruns=int(overrun))
        self._count_saturated(counts)
        if self._clock:
            self._clock.note_arrival(self.next_sample, time.monotonic() if arrived is None else arrived)
        return Block(
            counts=counts, first_sample=first_sample, t_ns=round(first_sample * 1e9 / self._rate), overrun=overrun
        )

    def count(self, **more: int) -> None:
        """Add to counters by name."""
        self._counted.update(more)

    def _count_saturated(self, counts: NDArray[np.int32]) -> None:
        """Count samples at the ends of the range; most blocks have none, as their two extremes show."""
        if not counts.size or (counts.min() > self._inner[0] and counts.max() < self._inner[1]):
            return
        self._saturated += np.count_nonzero((counts <= self._lowest) | (counts >= self._highest), axis=0)
