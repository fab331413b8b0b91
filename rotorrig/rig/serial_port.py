"""Serial ports: opening one for this program alone, and why it does not open."""

import os
import sys
from pathlib import Path

import serial
from serial.tools import list_ports

from rotorrig.rig.errors import LinkLost


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
