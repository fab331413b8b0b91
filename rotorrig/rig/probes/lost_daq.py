"""Bring back a DAQ whose samples have ended.

In a thread of its own, as a device that does not answer is waited for: the loop goes on and gives its sign of life.
"""

import math
import threading
from contextlib import suppress

from rotorrig.rig.clock import Clock
from rotorrig.rig.probes.base import Daq, DaqInfo

EVERY = 2.0  # s of wall time between tries
END_SECONDS = 5.0  # for a try that is under way when the sweep ends


class LostDaq:
    """Tries to open a DAQ again, until its stream runs."""

    def __init__(self, daq: Daq, info: DaqInfo, clock: Clock) -> None:
        self._daq, self._info, self._clock = daq, info, clock
        self._next_try = -math.inf  # wall time
        self._thread: threading.Thread | None = None
        self._streams = False

    def is_back(self) -> bool:
        """Return True once the stream runs again, from sample 0; begin a try if it is time for one."""
        if self._thread is None and self._clock.now() >= self._next_try:
            self._thread = threading.Thread(target=self._try, name="lost DAQ", daemon=True)
            self._thread.start()
        elif self._thread and not self._thread.is_alive():
            self._thread = None
            self._next_try = self._clock.now() + EVERY
            return self._streams
        return False

    def give_up(self) -> None:
        """Wait for a try that is under way."""
        if self._thread:
            self._thread.join(END_SECONDS)

    def _try(self) -> None:
        with suppress(Exception):
            self._daq.close()
        with suppress(Exception):
            if self._daq.open() == self._info:  # else it is another device, or set otherwise
                self._daq.start()
                self._streams = True
