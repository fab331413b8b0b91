"""Guard of a verb's outputs: nothing is lost to a slip of the keyboard.

An output is never an input of the same command, a file of another kind, or anything but a regular file; a file of the
same kind is replaced with `--force` alone. All this, and whether it can be written, is found out before the work.
"""

import os
import shutil
import stat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import Any, get_args, get_type_hints

from rotorrig.acquisition.files import KINDS, content_kind, refuse_leftover
from rotorrig.rig import DataError, provisional_path
from rotorrig.rig.config import bundled_configs

Arguments = Mapping[str, Any]  # of a verb, by their names
FORCE = "force"


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """Mark, in an argument's annotation, of a file to write."""

    kind: str | Callable[[Arguments], str]  # a key of KINDS, or how it follows from the arguments
    default: Callable[[Arguments], Path | None] = lambda _: None  # the file where none was named
    unless: str = ""  # the option with which nothing is written
    files: Callable[[Path], Mapping[Path, str]] | None = None  # of a folder: what is written into it, and their kinds


def guard(verb: Callable[..., None]) -> Callable[..., None]:
    """Return the verb with its outputs checked before it begins; one without outputs as it is."""
    marks = outputs_of(verb)
    if not marks:
        return verb
    parameters = signature(verb).parameters
    if FORCE not in parameters:
        raise TypeError(f"{verb.__name__}: writes a file, want the option --force")

    @wraps(verb)
    def check_and_run(**given: Any) -> None:
        check_outputs(marks, {name: parameter.default for name, parameter in parameters.items()} | given)
        verb(**given)

    return check_and_run


def outputs_of(verb: Callable[..., None]) -> dict[str, Output]:
    """Return the marks of a verb's outputs by the names of their arguments."""
    hints = get_type_hints(verb, include_extras=True)
    return {name: mark for name, hint in hints.items() for mark in get_args(hint) if isinstance(mark, Output)}


def check_outputs(marks: Mapping[str, Output], arguments: Arguments) -> None:
    """Check every file that a verb with these arguments would write. Raises DataError, in one sentence."""
    taken = {file: "the input file" for file in _inputs(arguments[name] for name in arguments if name not in marks)}
    for name, mark in marks.items():
        path = arguments[name] or mark.default(arguments)
        if path is None or arguments.get(mark.unless):
            continue
        kind = mark.kind if isinstance(mark.kind, str) else mark.kind(arguments)
        if mark.files is None:
            _check_folder(path.parent, path)
            _check_file(path, kind, taken, force=arguments[FORCE])
            if kind == "run":
                refuse_leftover(path)
            taken[path] = "an output already"
            continue
        _check_folder(next(folder for folder in (path, *path.absolute().parents) if os.path.lexists(folder)), path)
        for file, its_kind in mark.files(path).items():
            _check_file(file, its_kind, taken, force=arguments[FORCE])


def _inputs(values: Iterator[Any]) -> Iterator[Path]:
    """Yield the files among the values of a verb's arguments; a bundled config's, if it was given by name."""
    for value in values:
        for path in value if isinstance(value, list) else [value]:
            if isinstance(path, Path):
                yield path
            if isinstance(path, Path | str):
                yield from (bundled for name, bundled in bundled_configs().items() if name == str(path))


def _check_folder(folder: Path, path: Path) -> None:
    """Raise DataError unless a file can be made in the folder of an output."""
    try:
        made = provisional_path(folder / (path.name or "output"))  # "." and "/" have no name
        made.touch(exist_ok=False)
        made.unlink()
        free = shutil.disk_usage(folder).free
    except OSError as error:
        raise DataError(f"{path}: cannot be written ({error.strerror})") from error
    if not free:
        raise DataError(f"{path}: cannot be written (no space left)")


def _check_file(path: Path, kind: str, taken: Mapping[Path, str], *, force: bool) -> None:
    for other, what in taken.items():
        if _is_same(path, other):
            also = "" if path == other else f" {other}"
            raise DataError(f"{path}: is {what}{also}, want another name for what is written")
    try:
        mode = path.stat().st_mode
    except FileNotFoundError as error:
        if path.is_symlink():
            raise DataError(f"{path}: is a link to nothing, want another name") from error
        return
    except OSError as error:
        raise DataError(f"{path}: cannot be written ({error.strerror})") from error
    if not stat.S_ISREG(mode):
        what = "a folder" if stat.S_ISDIR(mode) else "a device, a pipe or a socket"
        raise DataError(f"{path}: is {what}, want a regular file")
    if (there := content_kind(path)) not in (kind, "empty"):
        raise DataError(f"{path}: is {KINDS[there]} already, want another name for {KINDS.get(kind, 'a file')}")
    if not force:
        raise DataError(f"{path}: is there already, want another name, or --force to replace it")
    if not mode & 0o222:
        raise DataError(f"{path}: is write-protected, want another name")


def _is_same(path: Path, other: Path) -> bool:
    """Return whether two paths lead to one file, by links of either kind; one that is not there counts by its name."""
    try:
        return path.samefile(other)
    except OSError:
        return os.path.realpath(path) == os.path.realpath(other)
