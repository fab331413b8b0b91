"""The recordings of a lab's tree: every run and response, told by its content and known by the hash of its bytes."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from rotorrig.acquisition.files import content_kind, is_mcap, read_source_hash
from rotorrig.app.lab.storage import FOLDER, Lab
from rotorrig.rig import DataError, file_hash

SUFFIX = ".mcap"
UNFINISHED = ".part"  # of a sweep that is under way, or was killed: `rotor salvage` makes a recording of it


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """A file of the tree to work through."""

    file: str  # relative to the lab's folder, with "/"
    run_id: str
    kind: str  # "run" or "response"


def find_recordings(lab: Lab, *, progress: Callable[[int, int], None] = lambda done, of: None) -> list[Recording]:
    """Return the recordings of a tree by their names, of equal files the first.

    A response made from a run of the tree is left out: the lab makes its own. A file that ends in .mcap and is none is
    taken for a recording: that it is damaged is found out, and said, as it is read. Raises DataError if a file cannot
    be read.
    """
    paths = list(_candidates(lab))
    found: dict[str, Recording] = {}
    sources: dict[str, str] = {}
    with ThreadPoolExecutor() as pool:  # hashing lets other threads run
        for number, (recording, source) in enumerate(pool.map(lambda path: _look_at(lab, path), paths), 1):
            progress(number, len(paths))
            if recording:
                found.setdefault(recording.run_id, recording)
                sources[recording.run_id] = source
    return [r for r in found.values() if r.kind != "response" or sources[r.run_id] not in found]


def _candidates(lab: Lab) -> Iterator[Path]:
    """Yield every MCAP file, or one that should be one, that is neither hidden nor in the lab's own folder."""
    for folder, folders, names in os.walk(lab.root):
        own = {FOLDER} if Path(folder) == lab.root else set()
        folders[:] = sorted(name for name in folders if not name.startswith(".") and name not in own)
        for name in sorted(names):
            path = Path(folder, name)
            if name.startswith(".") or name.endswith(UNFINISHED) or not path.is_file():
                continue
            if path.suffix == SUFFIX or is_mcap(path):
                yield path


def _look_at(lab: Lab, path: Path) -> tuple[Recording | None, str]:
    """Return the recording in a file, None if it is of another program, and the hash of what it was made from."""
    try:
        kind = content_kind(path)
        if kind not in ("run", "response", "other", "empty"):
            return None, ""
        source = read_source_hash(path) if kind == "response" else ""
        recording = Recording(file=lab.relative(path), run_id=file_hash(path), kind=_kind_of(kind))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    return recording, source


def _kind_of(content: str) -> str:
    return "response" if content == "response" else "run"
