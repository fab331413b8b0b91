"""Scans assembled from channels that arrive separately: only samples that all channels have.

A sample that one channel lacks is dropped of all, so what comes out has gaps where any input had one.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray


class ScanAssembler:
    """Takes segments of `channels` channels, each with the index of its first sample, and gives scans."""

    def __init__(self, channels: int) -> None:
        self._segments: list[deque[tuple[int, NDArray[np.int32]]]] = [deque() for _ in range(channels)]

    def add(self, channel: int, first: int, samples: NDArray[np.int32]) -> None:
        """Take consecutive samples of one channel, (sample,), that come after those it has given."""
        if len(samples):
            self._segments[channel].append((first, samples))

    def take(self) -> tuple[int, NDArray[np.int32]] | None:
        """Return the index of the first scan and counts (sample, channel) without a gap; None if none is whole."""
        while all(self._segments):
            starts = [segments[0][0] for segments in self._segments]
            first = max(starts)
            if min(starts) == first:
                return first, self._scans(first)
            for segments in self._segments:
                _drop_before(segments, first)
        return None

    def _scans(self, first: int) -> NDArray[np.int32]:
        length = min(len(segments[0][1]) for segments in self._segments)
        scans = np.stack([segments[0][1][:length] for segments in self._segments], axis=1)
        for segments in self._segments:
            _drop_before(segments, first + length)
        return scans


def _drop_before(segments: deque[tuple[int, NDArray[np.int32]]], first: int) -> None:
    while segments and segments[0][0] < first:
        start, samples = segments.popleft()
        if start + len(samples) > first:
            segments.appendleft((first, samples[first - start :]))
