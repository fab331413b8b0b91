"""Folders in which a recording goes on when its own has vanished: deleted, renamed or unmounted."""

import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path


def fallback_folders(path: Path) -> Iterator[Path]:
    """Yield existing folders to try in turn: the file's own if it is still there, then new ones nobody else has.

    The new ones are in the user's folder for state, `$XDG_STATE_HOME/rotorrig` or `~/.local/state/rotorrig`, and in the
    system's for temporary files.
    """
    if path.parent.is_dir():
        yield path.parent
    for base in (_state_folder, lambda: Path(tempfile.gettempdir())):
        with suppress(OSError, RuntimeError):  # no home, a disk that is full or read-only
            folder = base()
            folder.mkdir(parents=True, exist_ok=True)
            yield Path(tempfile.mkdtemp(prefix=time.strftime("rotorrig-%Y%m%d-%H%M%S-"), dir=folder))


def _state_folder() -> Path:
    home = os.environ.get("XDG_STATE_HOME")
    return (Path(home) if home else Path.home() / ".local/state") / "rotorrig"
