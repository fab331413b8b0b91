"""File under a provisional name, `<name>.part`, that takes its own name only when whole.

So a file of that name is never half a file, a crash leaves the `.part` with everything written until then, and the
good file of an earlier run is not lost to a bad one.
"""

import os
from collections import deque
from pathlib import Path

from rotorrig.rig import DataError


def part_path(path: Path) -> Path:
    """Return the provisional name of a file being written."""
    return path.with_name(path.name + ".part")


def refuse_existing(path: Path) -> None:
    """Raise DataError if `path` exists, or a `.part` that a crash left."""
    if path.exists():
        raise DataError(f"{path}: is there already, want a name that is free")
    if part_path(path).exists():
        raise DataError(
            f"{part_path(path)}: is there, of a recording cut short or under way; "
            f"`rotor salvage {part_path(path)} --out saved.mcap` saves what it holds, then remove it"
        )


class PartFile:
    """Unbuffered binary file with one writer; what was written outlives this process at once."""

    def __init__(self, path: Path, *, overwrite: bool) -> None:
        """Create `<path>.part`. Raises OSError; DataError unless `overwrite` if that or `path` is there already."""
        if not overwrite:
            refuse_existing(path)
        self._path = path
        self._file = part_path(path).open("wb" if overwrite else "xb", buffering=0)
        self._marks: deque[int] = deque(maxlen=4)  # newest last

    def write(self, data: bytes) -> int:
        """Write all of `data`. Raises OSError."""
        view = memoryview(data)
        while view:
            view = view[self._file.write(view) :]
        return len(data)

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._file.tell()

    def flush(self) -> None:
        """Do nothing: no byte is held back. The `mcap` writer wants the verb."""

    def keep_name(self) -> None:
        """Have the provisional name outlive a power cut. Raises OSError."""
        _sync_folder(self._path.parent)

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return self._file.fileno()

    def sync(self) -> None:
        """Wait until everything is on the medium, so that it outlives a power cut. Raises OSError."""
        os.fsync(self._file.fileno())

    def mark(self) -> None:
        """Mark what was written so far as a valid file once `end_early` has put its ending behind it."""
        self._marks.append(self.tell())

    def end_early(self, ending: bytes) -> int:
        """Cut back to the last mark and write `ending` there; return the bytes kept before it, 0 if none could be.

        On a full disk the cut makes the room for the ending; if that does not suffice, the mark before serves.
        """
        for mark in reversed(self._marks):
            try:
                self._file.truncate(mark)
                self._file.seek(mark)
                self.write(ending)
            except OSError:
                continue
            return mark
        return 0

    @property
    def closed(self) -> bool:
        """True once it has its name, or is gone."""
        return self._file.closed

    def take_name(self) -> None:
        """Close the file and give it its name, replacing an older one. Raises OSError."""
        self._file.close()
        part_path(self._path).replace(self._path)
        _sync_folder(self._path.parent)  # the new name outlives a power cut too

    def discard(self) -> None:
        """Close the file and remove it."""
        self._file.close()
        part_path(self._path).unlink(missing_ok=True)


def _sync_folder(path: Path) -> None:
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
