"""Lost and late samples: what has not arrived, or not yet, is not watched.

A frame lost now and then harms nothing: it is a gap in the recording, and every limit looks again 20 ms later. So many
that they would hide a fault are a trip, and so are samples that arrive long after they were taken.
"""

import math
from collections import deque

from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.probes import Block, DaqInfo

LONGEST_GAP = 0.5  # s in one piece: at 1 % of critical damping, vibration can pass through a critical speed in it
LOSS_WINDOW = 10.0  # s
LOSS_SHARE = 0.02  # of the window: ten frames of 20 ms; a sound link loses none in hours
LOSS_GAPS = 3  # fewer are no persistent loss, LONGEST_GAP is for them
LATE = 0.5  # s behind the promptest samples: a stop comes as much later
LATE_FOR = 0.25  # s of wall time: after a pause of this computer, the backlog is read in less
DRIFT = 2e-3  # s/s of the sample clock against this computer's, twice what a sound one has


class SampleLoss:
    """Gaps of the sample index over the last seconds."""

    def __init__(self, info: DaqInfo) -> None:
        self._rate = info.sample_rate
        self._next_sample: int | None = None  # None: no block yet
        self._gaps: deque[tuple[float, float]] = deque()  # (end, length) [s] of each in the window

    def follow(self, block: Block) -> float:
        """Take a block without judging it; return how many seconds are missing before it."""
        missing = 0 if self._next_sample is None else block.first_sample - self._next_sample
        self._next_sample = block.first_sample + len(block.counts)
        return missing / self._rate

    def check(self, block: Block) -> None:
        """Take a block. Raises LimitExceeded."""
        missing = self.follow(block)
        if missing <= 0:
            return
        if missing > LONGEST_GAP:
            raise LimitExceeded(
                f"DAQ: {missing:.2f} s of samples are missing in one piece, want at most {LONGEST_GAP:g} s; "
                "nothing is watched meanwhile"
            )
        end = block.first_sample / self._rate
        self._gaps.append((end, missing))
        while self._gaps[0][0] < end - LOSS_WINDOW:
            self._gaps.popleft()
        lost = sum(length for _, length in self._gaps)
        if len(self._gaps) >= LOSS_GAPS and lost > LOSS_SHARE * LOSS_WINDOW:
            raise LimitExceeded(
                f"DAQ: {lost * 1e3:.0f} ms of samples are missing in {len(self._gaps)} gaps within "
                f"{LOSS_WINDOW:g} s, want at most {LOSS_SHARE * LOSS_WINDOW * 1e3:.0f} ms; check its link"
            )


class LateSamples:
    """Age of the samples when they arrive, against the promptest of the run; not for a simulated sample clock."""

    def __init__(self, info: DaqInfo) -> None:
        self._rate = info.sample_rate
        self._watched = not info.simulated
        self._least = math.inf  # wall time less sample time of the promptest block [s]
        self._at = math.nan  # wall time of the last block [s]
        self._late_since = math.nan  # wall time [s]; NaN: the last block was not late

    def check(self, block: Block, now: float) -> None:
        """Take a block that was read at the wall time `now` [s]. Raises LimitExceeded."""
        if not self._watched:
            return
        lag = now - (block.first_sample + len(block.counts)) / self._rate
        drift = 0.0 if math.isnan(self._at) else DRIFT * (now - self._at)
        self._at, self._least = now, min(self._least + drift, lag)
        late = lag - self._least
        if late <= LATE:
            self._late_since = math.nan
            return
        if math.isnan(self._late_since):
            self._late_since = now
        if now - self._late_since >= LATE_FOR:
            raise LimitExceeded(
                f"DAQ: its samples arrive {late:.1f} s late, want at most {LATE:g} s; is this computer overloaded?"
            )
