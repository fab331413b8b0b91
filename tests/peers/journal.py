"""Journal of a peer bench: JSON lines of the true speed and of everything a judge outside has to know."""

import json
import time
from pathlib import Path
from typing import Any


class Journal:
    """Appends lines to a file; each has `t`, the machine's monotonic clock [s], common to all its processes."""

    def __init__(self, path: Path) -> None:
        """Begin the file."""
        self._file = path.open("w", encoding="utf-8", buffering=1)

    def event(self, name: str, **facts: Any) -> None:
        """Write that something has happened."""
        line = json.dumps({"t": round(time.monotonic(), 4), "event": name, **facts})
        self._file.write(line + "\n")

    def truth(self, *, rpm: float, on: bool, sent: int) -> None:
        """Write the rotor's true speed, whether the drive's output is on, and the scans sampled since START."""
        line = {"t": round(time.monotonic(), 4), "rpm": round(rpm, 2), "on": on, "sent": sent}
        self._file.write(json.dumps(line) + "\n")

    def close(self) -> None:
        """End the file."""
        self._file.close()
