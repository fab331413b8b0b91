"""Fair lock for a wire shared by several threads: first come, first served, a stop before all others."""

import threading
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager


class Turns:
    """A fair lock with a fast lane: `take(first=True)` waits for the turn under way and for nobody else's."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._taken = False
        self._queue: deque[object] = deque()

    @contextmanager
    def take(self, *, first: bool = False) -> Iterator[None]:
        """Wait for a turn and have it for the length of the block."""
        ticket = object()
        with self._changed:
            (self._queue.appendleft if first else self._queue.append)(ticket)
            try:
                # without the queue, who asks again at once would mostly be served before who has waited
                self._changed.wait_for(lambda: not self._taken and self._queue[0] is ticket)
                self._taken = True
            finally:
                self._queue.remove(ticket)
                self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._taken = False
                self._changed.notify_all()
