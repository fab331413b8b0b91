"""Order of a stream DAQ's DATA frames: gaps, repeated and late frames, and restarts of the device."""

from collections import deque
from enum import Enum

import numpy as np

from rotorrig.rig.errors import LinkLost
from rotorrig.rig.probes.stream.frames import Data

SEQUENCES = 1 << 32
BEHIND = 32  # a frame up to so many behind the newest is an old one come again; further back the device has restarted
STALE_IN_A_ROW = 8  # ... and so has one that sends so many of them and nothing else
LONGEST_GAP = 3600.0  # s; a jump beyond is no gap but a broken counter


class Place(Enum):
    """Place of a frame in the stream."""

    NEXT = "next"  # after what came so far, perhaps with a gap before it
    REPEATED = "repeated"  # its samples came before
    LATE = "late"  # its samples were missing, and later ones came before it


class FrameSequence:
    """The order of one stream, from START on."""

    def __init__(self, *, sample_rate: float) -> None:
        self._longest_gap = round(LONGEST_GAP * sample_rate)
        self._next_sequence = 0
        self._next_scan = 0
        self._missed: deque[int] = deque(maxlen=BEHIND)  # sequence numbers of frames not come
        self._newest: deque[Data] = deque(maxlen=BEHIND)
        self._stale = 0  # in a row
        self._fault: str | None = None  # what ended the stream: frames after it belong to another one

    def place(self, frame: Data) -> tuple[Place, int]:
        """Return where the frame belongs and how many frames are missing before it, if it is the next.

        Raises LinkLost if no sound stream could go on like this, then and for every frame after it: the device
        restarted, or its counters are broken.
        """
        if self._fault is None:
            try:
                return self._place(frame)
            except LinkLost as error:
                self._fault = str(error)
                raise
        raise LinkLost(self._fault)

    def _place(self, frame: Data) -> tuple[Place, int]:
        behind = (self._next_sequence - frame.sequence) % SEQUENCES
        if frame.first_scan < self._next_scan:
            return self._place_old(frame, behind), 0
        missing = (frame.sequence - self._next_sequence) % SEQUENCES
        jump = frame.first_scan - self._next_scan
        if missing > SEQUENCES // 2 or jump > self._longest_gap:
            raise LinkLost(
                f"the DAQ's counters are broken: scan {frame.first_scan} in frame {frame.sequence} "
                f"after scan {self._next_scan - 1} in frame {(self._next_sequence - 1) % SEQUENCES}"
            )
        self._missed.extend((self._next_sequence + k) % SEQUENCES for k in range(max(0, missing - BEHIND), missing))
        self._next_sequence = (frame.sequence + 1) % SEQUENCES
        self._next_scan = frame.first_scan + len(frame.counts)
        self._newest.append(frame)
        self._stale = 0
        return Place.NEXT, missing

    def _place_old(self, frame: Data, behind: int) -> Place:
        self._stale += 1
        if frame.sequence in self._missed:
            self._missed.remove(frame.sequence)
            return Place.LATE
        first_of_a_stream = frame.first_scan == 0 and not self._is_the_last_one(frame)
        unlikely = not 0 < behind <= BEHIND or self._stale > STALE_IN_A_ROW
        if first_of_a_stream or unlikely or self._contradicts(frame):
            raise LinkLost(f"the DAQ went back to scan {frame.first_scan} after {self._next_scan}; has it restarted?")
        return Place.REPEATED

    def _is_the_last_one(self, frame: Data) -> bool:
        return bool(self._newest) and self._newest[-1].sequence == frame.sequence and not self._contradicts(frame)

    def _contradicts(self, frame: Data) -> bool:
        """Return whether a frame of that number came before with other samples: it is no repetition."""
        before = next((one for one in self._newest if one.sequence == frame.sequence), None)
        return before is not None and not np.array_equal(before.counts, frame.counts)
