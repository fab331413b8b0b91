"""A computer that must not fall asleep while a rotor turns, and the notice that it did all the same."""

import contextlib
import shutil
import subprocess
import sys
import time

SLEPT = 0.5  # s that the clock which runs on during sleep must be ahead, to be sure


class SleepGuard:
    """Keeps the computer awake where the system lets it, from `start` to `end`."""

    def __init__(self) -> None:
        self._holder: subprocess.Popen[bytes] | None = None
        self._asleep = _asleep()

    def start(self) -> bool:
        """Ask the system to stay awake; return whether there is something to ask."""
        if self._holder is None and (command := _inhibitor()):
            with contextlib.suppress(OSError):
                self._holder = subprocess.Popen(
                    command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
        return self._holder is not None

    def slept(self) -> float:
        """Return for how long the computer slept since the last call [s]; 0: it did not."""
        before, self._asleep = self._asleep, _asleep()
        seconds = self._asleep - before
        return seconds if seconds > SLEPT else 0.0

    def end(self) -> None:
        """Let it sleep again."""
        if self._holder and self._holder.stdin:
            with contextlib.suppress(OSError, subprocess.TimeoutExpired):
                self._holder.stdin.close()  # what it waits for
                self._holder.terminate()
                self._holder.wait(5)
        self._holder = None


def _asleep() -> float:
    """Seconds for which this computer has slept since it was started; 0 where the system does not tell."""
    if not hasattr(time, "CLOCK_BOOTTIME"):
        return 0.0
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.clock_gettime(time.CLOCK_MONOTONIC)


def _inhibitor() -> list[str]:
    """Command that keeps the system awake while it runs; empty: there is none here."""
    if tool := shutil.which("systemd-inhibit"):
        why = ["--what=sleep:idle:handle-lid-switch", "--who=rotor", "--why=a rotor turns", "--mode=block"]
        return [tool, *why, "cat"]
    if sys.platform == "darwin" and (tool := shutil.which("caffeinate")):
        return [tool, "-is", "cat"]
    return []
