"""Why a serial port does not open, in words a person can act on."""

import os
from pathlib import Path

from serial.tools import list_ports


def why_closed(port: str) -> str:
    """Return why `port` may have refused to open: no such port (and which there are), no permission, in use."""
    if not Path(port).exists() and not port.upper().startswith("COM"):
        found = ", ".join(sorted(p.device for p in list_ports.comports())) or "none"
        return f"no such port; ports found: {found}"
    if Path(port).exists() and not os.access(port, os.R_OK | os.W_OK):
        return "no permission; on Linux its user must be in the group that owns it, often 'dialout'"
    return "in use by another program, or no serial port"
