"""Diagnosis of a serial port that does not open."""

import os
from pathlib import Path

from serial.tools import list_ports


def diagnose_port(port: str) -> str:
    """Return the likely reason that `port` does not open: no such port (and those there are), no permission, in use."""
    if not Path(port).exists() and not port.upper().startswith("COM"):
        present = ", ".join(sorted(p.device for p in list_ports.comports())) or "none"
        return f"no such port; ports found: {present}"
    if Path(port).exists() and not os.access(port, os.R_OK | os.W_OK):
        return "no permission; on Linux its user must be in the group that owns it, often 'dialout'"
    return "in use by another program, or no serial port"
