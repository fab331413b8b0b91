"""A line controller on a pseudo-terminal, run by a thread of the test, and what it was commanded and when."""

import os
import pty
import select
import threading
import time
import tty
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.peers.inverter import Inverter
from tests.peers.journal import Journal
from tests.peers.line_controller import LineController

STEP = 0.002  # s between steps of the output


class Commands(Journal):
    """Commands in the order they came: when [s, monotonic], and of what kind."""

    def __init__(self) -> None:
        self.came: list[tuple[float, str]] = []

    def event(self, name: str, **facts: Any) -> None:
        self.came.append((time.monotonic(), facts.get("kind", name)))


class LineDrive:
    """The drive; a port that nobody reads while it is `deaf`."""

    def __init__(self) -> None:
        self.deaf = False
        self.journal = Commands()
        self.inverter = Inverter(self.journal)
        self._controller = LineController(self.inverter)
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = Path(os.ttyname(self._slave))
        self._over = False
        self._thread = threading.Thread(target=self._run, name="drive")
        self._thread.start()

    def stops(self, *, since: float) -> list[float]:
        """Times of the stops of any kind that came after `since`."""
        return [t for t, kind in self.journal.came if t >= since and kind in ("ramp", "quick", "coast")]

    def close(self) -> None:
        """Take it away."""
        self._over = True
        self._thread.join()
        for end in (self._master, self._slave):
            os.close(end)

    def _run(self) -> None:
        hear = self._controller.connect(self._send)
        before = time.monotonic()
        while not self._over:
            if select.select([self._master], [], [], STEP)[0]:
                with suppress(OSError):
                    data = os.read(self._master, 4096)
                    if not self.deaf:
                        hear(data)
            now = time.monotonic()
            self.inverter.advance(now - before)
            before = now

    def _send(self, data: bytes) -> None:
        os.write(self._master, data)
