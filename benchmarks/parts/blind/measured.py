"""Sweeps of blind cases that are kept: simulating one takes as long as diagnosing it, and is done once.

The tracked responses of a case lie as response.mcap files, beside its sealed truth, in a folder named after the code
that made them: when the plant, a fault of the case, the tracking or the config changes, they are measured anew.
"""

import hashlib
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.parts.blind.cases import CONFIG, Case, measure
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_response, write_response
from rotorrig.sims.plant.faults.base import fault_names

ROOT = Path(__file__).parents[3]
FAULTS = ROOT / "rotorrig/sims/plant/faults"
FOLDERS = (ROOT / "rotorrig/sims/plant", ROOT / "rotorrig/processing")
FILES = (ROOT / "benchmarks/parts/blind/cases.py", ROOT / "benchmarks/parts/blind/run.py", CONFIG)


def measured(case: Case, folder: Path, *, sealed: Path) -> list[OrderTrackedResponse]:
    """Return the tracked responses of a case, kept in `folder` from an earlier run or else now; seal its truth."""
    place = folder / "measured" / digest(case.faults) / case.design / case.name
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=place.parent) as scratch:
            whole = Path(scratch) / "whole"
            whole.mkdir()
            responses = measure(case, sealed=whole / "sealed.json", folder=Path(scratch))
            for i, response in enumerate(responses):
                write_response(whole / f"{i + 1}.response.mcap", response)
            whole.rename(place)
    sealed.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(place / "sealed.json", sealed)
    return [read_response(path) for path in sorted(place.glob("*.response.mcap"))]


@cache
def digest(faults: tuple[str, ...]) -> str:
    """Return a digest of the code and the config that a measurement with these faults depends on."""
    found = hashlib.sha256()
    for path in _sources(faults):
        found.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:12]


def _sources(faults: tuple[str, ...]) -> Iterator[Path]:
    other = {FAULTS / f"{name}.py" for name in fault_names() if name not in faults}
    for folder in FOLDERS:
        yield from (path for path in sorted(folder.rglob("*.py")) if path not in other)
    yield from FILES
