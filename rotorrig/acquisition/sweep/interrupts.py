"""Ctrl-C, `kill` and a closed terminal while a rotor turns: each stops it, none ends the program before it is at rest.

The first one aborts the sweep, the second is an emergency stop. Later ones leave a rotor that cannot be proven at rest,
see run_down.py.
"""

import signal
import threading
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Self

HANDLED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
NAMES = {
    signal.SIGINT: "Ctrl-C",
    signal.SIGTERM: "SIGTERM",
    signal.SIGHUP: "the terminal was closed",
    signal.SIGQUIT: "Ctrl-\\",
}
EMERGENCY_COUNT = 2  # signals that make an emergency stop


class Interrupts:
    """Counter of the signals that would otherwise end the program, while its `with` block runs in the main thread.

    The first two call `stop` at once, from the signal handler: the rotor does not wait for a loop that may hang. If
    `loop_hangs()`, the third breaks out of it as KeyboardInterrupt.
    """

    def __init__(self, *, stop: Callable[[], None], loop_hangs: Callable[[], bool]) -> None:
        self.count = 0
        self.first = ""  # name of the first
        self._stop, self._hangs = stop, loop_hangs
        self._before: dict[signal.Signals, object] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():  # Python delivers signals to that one only
            self._before = {number: signal.signal(number, self._handle) for number in HANDLED}
            # Ctrl-Z would leave the rotor turning with nobody to watch it
            self._before[signal.SIGTSTP] = signal.signal(signal.SIGTSTP, signal.SIG_IGN)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]

    def _handle(self, number: int, frame: FrameType | None) -> None:
        self.count += 1
        self.first = self.first or NAMES[signal.Signals(number)]
        if self.count <= EMERGENCY_COUNT:
            self._stop()
        elif self._hangs():
            raise KeyboardInterrupt
