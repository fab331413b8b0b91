"""File under a provisional name that takes its own name only when whole; a recording's is `<name>.part`.

So a file of that name is never half a file, a crash leaves the `.part` with everything written until then, and the
good file of an earlier run is not lost to a bad one.
"""

import errno
import fcntl
import os
from collections import deque
from io import FileIO
from pathlib import Path

from rotorrig.rig import DataError, provisional_path, sync_folder

_PIECE = 1 << 20  # bytes copied at a time


def part_path(path: Path) -> Path:
    """Return the provisional name of a file being written."""
    return path.with_name(path.name + ".part")


def refuse_existing(path: Path) -> None:
    """Raise DataError if `path` exists, or a `.part` that a crash left."""
    if path.exists():
        raise DataError(f"{path}: is there already, want a name that is free")
    refuse_leftover(path)


def refuse_leftover(path: Path) -> None:
    """Raise DataError if a crash left a `.part` of `path` that holds anything."""
    part = part_path(path)
    if os.path.lexists(part) and not (part.is_file() and part.stat().st_size == 0):
        raise DataError(
            f"{part}: is there, of a recording cut short or under way; "
            f"`rotor salvage {part} --out saved.mcap` saves what it holds, then remove it"
        )


class PartFile:
    """Unbuffered binary file with one writer; what was written outlives this process at once."""

    def __init__(self, path: Path, *, overwrite: bool, salvageable: bool = False) -> None:
        """Create the provisional file of `path`: `<path>.part` if it is worth a salvage, else a hidden one.

        Raises OSError; DataError unless `overwrite` if `path` is there already, and for a `.part` that holds anything.
        """
        if path.exists() and not overwrite:
            raise DataError(f"{path}: is there already, want a name that is free")
        self.path = path = path.resolve() if path.is_symlink() else path  # the file it points to, not the link
        self._overwrite = overwrite
        self._part = part_path(path) if salvageable else provisional_path(path)
        if salvageable:
            refuse_leftover(path)
            self._file = self._part.open("a+b", buffering=0)  # an empty one holds nothing that could be lost
            _lock(self._file, self._part)
        else:
            self._file = self._part.open("xb", buffering=0)
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
        sync_folder(self.path.parent)

    @property
    def astray(self) -> bool:
        """True if its name no longer leads to it: the folder was deleted or renamed, or the name taken away."""
        try:
            return not os.path.samestat(self._part.stat(), os.fstat(self.fileno()))
        except OSError:
            return True

    def move_to(self, folder: Path) -> None:
        """Go on in another folder, with all that was written. Raises OSError, and then stays where it is.

        A deleted file keeps its data for as long as it is open, and is copied from there.
        """
        path = folder / self.path.name
        if path.exists() and not self._overwrite:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        part = part_path(path)
        file = part.open("x+b", buffering=0)
        try:
            _copy(self.fileno(), file.fileno())
        except BaseException:
            file.close()
            part.unlink(missing_ok=True)
            raise
        _lock(file, part)
        self._file.close()
        self._file, self._part, self.path = file, part, path

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return self._file.fileno()

    def sync(self) -> None:
        """Wait until everything is on the medium, so that it outlives a power cut. Raises OSError."""
        os.fsync(self._file.fileno())

    def mark(self) -> None:
        """Mark what was written so far as a valid file once `end_early` has put its ending behind it."""
        self._marks.append(self.tell())

    @property
    def marked(self) -> bool:
        """True if something of it is worth a salvage."""
        return bool(self._marks)

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
        """Give the file its name, replacing an older one if it may, and close it. Raises OSError, and stays open."""
        if self.path.exists() and not self._overwrite:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(self.path))
        self._part.replace(self.path)
        self._file.close()
        sync_folder(self.path.parent)  # the new name outlives a power cut too

    def close(self) -> None:
        """Close the file and leave it under its provisional name."""
        self._file.close()

    def discard(self) -> None:
        """Close the file and remove it."""
        self._file.close()
        self._part.unlink(missing_ok=True)


def _copy(source: int, target: int) -> None:
    """Copy a file by its open descriptor, which need not have a name, to the end of another. Raises OSError."""
    offset = 0
    while data := os.pread(source, _PIECE, offset):
        offset += len(data)
        view = memoryview(data)
        while view:
            view = view[os.write(target, view) :]


def _lock(file: FileIO, part: Path) -> None:
    """Hold the file until it is closed. Raises DataError if another program does; a disk without locks does without."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno == errno.EWOULDBLOCK:
            file.close()
            raise DataError(f"{part}: is being written by another program, want another name") from error
