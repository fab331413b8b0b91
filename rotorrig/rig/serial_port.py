"""Serial ports: opening one for this program alone, whether it is still the same, and why it does not open."""

import os
import sys
from pathlib import Path

import serial
from serial.tools import list_ports

from rotorrig.rig.errors import LinkLost

PSEUDO_TERMINALS = "/dev/pts/"
MOST_LINKS = 40  # in a row, as the kernel follows

Identity = tuple[int, int]  # inode and its time of change [ns]; a new node under an old number has a new one


def open_serial(
    port: str, baudrate: int, *, of: str, timeout: float | None = None, write_timeout: float | None = None
) -> serial.Serial:
    """Open the port of a device, `of` names it, with DTR and RTS kept when it is closed. Raises LinkLost."""
    try:
        opened = serial.Serial(port, baudrate, timeout=timeout, write_timeout=write_timeout, exclusive=True)
    except (OSError, ValueError) as error:
        raise LinkLost(f"{port}: the {of}'s port cannot be opened ({diagnose_port(port)})") from error
    keep_lines_when_closed(opened)
    return opened


class ReopenedPort:
    """A port that is opened again and again: a pseudo-terminal whose number went to another program is left alone.

    A port that was unplugged and is back may be opened again whatever its number is now. The number of a
    pseudo-terminal is given to the next program that asks for one, so it has to be the one of before, unless its name
    is a link that was made anew since.
    """

    def __init__(self, port: str) -> None:
        self._port = port
        self._before: tuple[Identity, list[Identity]] | None = None  # the pseudo-terminal and the links to it

    def check(self) -> None:
        """Check before every opening that the port is the one of before. Raises LinkLost."""
        try:
            now = _pseudo_terminal(self._port)
        except OSError:  # it is not there: who opens it will say so
            return
        if now and self._before and now[0] != self._before[0] and now[1] == self._before[1]:
            raise LinkLost(f"{self._port}: this pseudo-terminal was made after the one opened before; whose is it now?")
        self._before = now


def _pseudo_terminal(port: str) -> tuple[Identity, list[Identity]] | None:
    """Return which pseudo-terminal a name stands for and the links to it; None: it is none. Raises OSError."""
    links: list[Identity] = []
    path = Path(port)
    while path.is_symlink() and len(links) < MOST_LINKS:
        links.append(_identity(path.lstat()))
        path = path.parent / path.readlink()
    return (_identity(path.stat()), links) if str(path.resolve()).startswith(PSEUDO_TERMINALS) else None


def _identity(found: os.stat_result) -> Identity:
    return found.st_ino, found.st_ctime_ns


def keep_lines_when_closed(port: serial.Serial) -> None:
    """Clear HUPCL, where the system has it, so that closing an open port leaves DTR and RTS as they are.

    Many boards start anew when DTR rises: one whose port is closed and opened during a run would forget its watchdog.
    The first opening after it was plugged in still raises DTR.
    """
    if sys.platform != "win32":
        import termios

        try:
            settings = termios.tcgetattr(port.fileno())
            settings[2] &= ~termios.HUPCL
            termios.tcsetattr(port.fileno(), termios.TCSANOW, settings)
        except (termios.error, OSError):
            pass  # no terminal, or gone: who reads it will say so


def diagnose_port(port: str) -> str:
    """Return the likely reason that `port` does not open: no such port (and those there are), no permission, in use."""
    if not Path(port).exists() and not port.upper().startswith("COM"):
        present = ", ".join(sorted(p.device for p in list_ports.comports())) or "none"
        return f"no such port; ports found: {present}"
    if Path(port).exists() and not os.access(port, os.R_OK | os.W_OK):
        return "no permission; on Linux its user must be in the group that owns it, often 'dialout'"
    return "in use by another program, or no serial port"
