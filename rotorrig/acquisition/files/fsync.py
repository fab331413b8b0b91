"""Periodic fsync against power cuts: about once a second, on a thread that nothing waits for.

An fsync takes 7.5 ms on a good SSD and seconds on a bad day of an SD card. Writing goes on meanwhile, as far as the
file system lets it.
"""

import os
import threading

SYNC_EVERY = 1.0  # s of real time from the end of one to the next


class Syncer:
    """Syncs an open file until closed; owns a descriptor of its own, so that the file may be closed at any time."""

    def __init__(self, fd: int, *, every: float = SYNC_EVERY) -> None:
        """Start the thread. Raises OSError if there is no descriptor to be had."""
        self.fault: OSError | None = None  # why it ended by itself: the medium took back what the system had accepted
        self._fd = os.dup(fd)
        self._every = every
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="file sync", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread once a sync under way is done; may be called twice."""
        self._ending.set()
        self._thread.join()

    def _run(self) -> None:
        try:
            while not self._ending.wait(self._every):
                os.fsync(self._fd)
        except OSError as error:
            self.fault = error
        finally:
            os.close(self._fd)
