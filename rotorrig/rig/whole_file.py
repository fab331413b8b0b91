"""Files written whole or not at all: under a provisional name in the same folder, then renamed.

Whatever stood there before stays as it is until the new file is complete and on the medium.
"""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from rotorrig.rig.errors import DataError


@contextmanager
def write_whole_file(path: Path) -> Iterator[IO[bytes]]:
    """Open a file for the length of the `with` block; it takes its name if the block ends well. Raises DataError."""
    with provisional_file(path) as made, made.open("wb") as file:
        yield file


def write_whole_text(path: Path, text: str) -> None:
    """Write `text` to a file, whole or not at all. Raises DataError if it cannot be written."""
    with write_whole_file(path) as file:
        file.write(text.encode())


@contextmanager
def provisional_file(path: Path) -> Iterator[Path]:
    """Make an empty file beside `path`, for others to write; it takes the name `path` if the block ends well.

    A link is followed: the file it points to is replaced, not the link. Raises DataError if that is not possible.
    """
    made: Path | None = None
    try:
        target = path.resolve()
        made = provisional_path(target)
        made.touch(exist_ok=False)
        yield made
        _sync(made)
        made.replace(target)
        made = None
        sync_folder(target.parent)  # the new name outlives a power cut too
    except OSError as error:
        raise DataError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        if made is not None:
            with suppress(OSError):
                made.unlink()


def provisional_path(path: Path) -> Path:
    """Return a free name beside `path`, hidden, for what will take its name."""
    return path.with_name(f".{path.name[:100]}-{secrets.token_hex(4)}.part")


def sync_folder(path: Path) -> None:
    """Wait until the names in a folder are on the medium. Raises OSError."""
    _sync(path)


def _sync(path: Path) -> None:
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
