"""Atomic writing of a file: whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rotorrig.acquisition.files import PartFile
from rotorrig.rig import DataError


@contextmanager
def write_whole_file(path: Path) -> Iterator[PartFile]:
    """Open a file for the length of the `with` block; it takes its name if the block ends well. Raises DataError."""
    try:
        file = PartFile(path, overwrite=True)
    except OSError as error:
        raise DataError(f"{path}: cannot be written ({error.strerror})") from error
    try:
        yield file
        file.take_name()
    except OSError as error:
        raise DataError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        if not file.closed:
            file.discard()
