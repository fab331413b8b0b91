"""`rotor sweep` as an operator starts it: a process on a terminal of its own; its lines are kept with their times."""

import fcntl
import os
import pty
import re
import resource
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

GUARDIAN = "rotorrig.rig.control.guardian"  # in the command line of the process that owns the motor link
MARK = "ROTORRIG_SOAK_RUN"  # variable that tells the processes of a run from others
_CODES = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1b[@-Z\\-_]")
_TYPED = {"SIGINT": b"\x03", "SIGQUIT": b"\x1c"}


@dataclass(frozen=True, slots=True)
class Line:
    """A line of the program's output."""

    t: float  # s, monotonic
    text: str


class Program:
    """The program under test, its terminal, and its guardian."""

    def __init__(self, words: Iterable[str], *, folder: Path, root: Path, mark: str, piped: bool) -> None:
        """Start it; its standard output goes to a pipe if `piped`, to the terminal otherwise."""
        self._master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 1000, 0, 0))
        self._pipe, write = os.pipe() if piped else (-1, -1)
        self._mark = mark
        self._partial = {self._master: b"", self._pipe: b""}
        self.lines: list[Line] = []
        self.guardians: dict[int, psutil.Process] = {}
        self.status: int | None = None  # exit status, negative: killed by that signal
        self.ended = float("nan")  # when, s monotonic
        self.cpu = 0.0  # s
        env = {**os.environ, "PYTHONPATH": str(root), "HOME": str(folder), "TMPDIR": str(folder), MARK: mark}
        env |= {"TERM": "xterm", "COLUMNS": "1000", "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "rotorrig.app.cli", *words],
            stdin=slave,
            stdout=write if piped else slave,
            stderr=slave,
            cwd=folder,
            env=env,
            start_new_session=True,
            preexec_fn=_begin,
        )
        os.close(slave)
        if piped:
            os.close(write)
        self.pid = self._process.pid

    def listen(self, seconds: float) -> None:
        """Take what it says for so long, or until it has ended and all is said."""
        ends = [end for end in (self._master, self._pipe) if end >= 0]
        ready, _, _ = select.select(ends, [], [], seconds) if ends else ([], [], time.sleep(seconds))
        for end in ready:
            data = b""
            with suppress(OSError):
                data = os.read(end, 65536)
            if data:
                self._hear(end, data)
            else:
                self._close(end)
        self._look()

    def strike(self, name: str) -> None:
        """Send a signal; what an operator types, he types while there is a terminal."""
        if self.status is not None:
            return
        if name in _TYPED and self._master >= 0:
            with suppress(OSError):
                os.write(self._master, _TYPED[name])
                return
        with suppress(ProcessLookupError):
            os.kill(self.pid, signal.Signals[name])

    def close_terminal(self) -> None:
        """Close its terminal, as a window is closed."""
        self._close(self._master)

    def close_pipe(self) -> None:
        """Close the reading end of its standard output."""
        self._close(self._pipe)

    def fill_disk(self, size: int) -> None:
        """Let no file of the program and its guardian grow beyond `size` bytes from now on."""
        for pid in (self.pid, *self.find_guardians()):
            with suppress(OSError, ProcessLookupError):
                resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    def find_guardians(self) -> list[int]:
        """Return the process ids of its guardians that live."""
        for process in psutil.process_iter():
            with suppress(psutil.Error):
                new = process.pid not in self.guardians and GUARDIAN in " ".join(process.cmdline())
                if new and process.environ().get(MARK) == self._mark:
                    self.guardians[process.pid] = process
        return [pid for pid, process in self.guardians.items() if _lives(process)]

    def kill_guardians(self) -> int:
        """Kill its guardians; return how many there were."""
        pids = self.find_guardians()
        for pid in pids:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        return len(pids)

    def close(self) -> None:
        """End whatever is left of the run."""
        if self.status is None:
            self.strike("SIGCONT")
            self.strike("SIGKILL")
            self._process.wait()
        self.kill_guardians()
        self._close(self._master)
        self._close(self._pipe)

    def _hear(self, end: int, data: bytes) -> None:
        now = time.monotonic()
        *lines, self._partial[end] = re.split(rb"[\r\n]+", self._partial[end] + data)
        for line in lines:
            if text := _CODES.sub("", line.decode("utf-8", "replace")).strip():
                self.lines.append(Line(now, text))

    def _close(self, end: int) -> None:
        if end < 0:
            return
        if end == self._master:
            self._master = -1
        else:
            self._pipe = -1
        os.close(end)

    def _look(self) -> None:
        """See whether it has ended."""
        if self.status is not None:
            return
        pid, status, usage = os.wait4(self.pid, os.WNOHANG)
        if pid:
            self.ended = time.monotonic()
            self.status = os.waitstatus_to_exitcode(status)
            self._process.returncode = self.status
            self.cpu = usage.ru_utime + usage.ru_stime


def _begin() -> None:
    """Make the terminal the program's own, and let no signal be ignored that whoever started this ignores."""
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)


def _lives(process: psutil.Process) -> bool:
    with suppress(psutil.Error):
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    return False
