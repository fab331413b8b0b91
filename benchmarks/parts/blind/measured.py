"""Sweeps of blind cases, and those that are kept: simulating one takes as long as diagnosing it, and is done once.

The truth is sealed into a file before the first sweep; what is handed on is the tracked responses and nothing else. A
case whose sweep trips is drawn again. The responses lie as response.mcap files in a folder named after the code that
made them: when the plant, a fault of the case, the tracking or a config changes, they are measured anew.
"""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.parts.blind.cases import RUNS, Case, draw_again, sizes
from benchmarks.parts.blind.rigs.drawn import RK4
from benchmarks.parts.blind.run import record
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording, write_recording
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.processing.files import read_response, write_response
from rotorrig.rig import LimitExceeded
from rotorrig.sims.plant import FaultSpec, draw, seal
from rotorrig.sims.plant.faults.base import fault_names

ROOT = Path(__file__).parents[3]
FAULTS = ROOT / "rotorrig/sims/plant/faults"
FOLDERS = (ROOT / "rotorrig/sims/plant", ROOT / "rotorrig/processing", ROOT / "benchmarks/parts/blind/rigs")
FILES = (ROOT / "benchmarks/parts/blind/cases.py", ROOT / "benchmarks/parts/blind/run.py", Path(__file__), RK4)
GRAVITY = 9.81  # m/s^2
TRIAL = (12e-6, math.pi / 2)  # kg m, rad from the keyphasor mark in the sense of rotation: on the RK4
TRIAL_FORCE = 0.1  # of a disk's weight, at the highest speed: API 684's rule for a trial mass
MOST_TRIPS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A case as it was swept."""

    case: Case  # as drawn last
    responses: list[OrderTrackedResponse]
    sealed: Path  # the truth


def measured(case: Case, folder: Path) -> Measured:
    """Return the tracked responses of a case, kept in `folder` from an earlier run or else now.

    Raises LimitExceeded if every one of `MOST_TRIPS` drawings of it trips.
    """
    place = folder / "measured" / digest(case.faults) / case.design / case.name
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=place.parent) as scratch:
            whole = Path(scratch) / "whole"
            _measure_untripped(case, whole, Path(scratch))
            whole.rename(place)
    drawn = replace(case, again=int((place / "again").read_text(encoding="utf-8")))
    responses = [read_response(path) for path in sorted(place.glob("*.response.mcap"))]
    return Measured(case=drawn, responses=responses, sealed=place / "sealed.json")


def measure(
    case: Case, *, sealed: Path, folder: Path, faults: tuple[FaultSpec, ...] | None = None, runs: int | None = None
) -> list[OrderTrackedResponse]:
    """Seal the truth of a case into a file, sweep its rig and return the tracked responses; `faults` as drawn if None.

    One of two `runs` has a trial mass; None: as many as the design has. Recordings go through files in `folder`. A
    response names neither its seed nor its case. Raises LimitExceeded.
    """
    rig, seed = case.rig, case.plant_seed
    geometry, _ = case.geometry
    hidden = sizes(case) if faults is None else faults
    seal(replace(draw(rig, seed=seed, faults=hidden), geometry=geometry), sealed)
    first = record(rig, seed=seed, faults=hidden, geometry=geometry, guarded=True)
    responses = [_tracked(first, folder / "run 1.mcap")]
    if (runs or RUNS[case.design]) > 1:
        disk, (amount, angle) = rig.disks[0].name, trial_mass(case)
        again = record(
            rig, seed=seed, faults=hidden, trial={disk: (amount, angle)}, run=1, geometry=geometry, guarded=True
        )
        known = {disk: amount * complex(math.cos(angle), math.sin(angle))}
        responses.append(_with_trial(_tracked(again, folder / "run 2.mcap"), known))
    return responses


def trial_mass(case: Case) -> tuple[float, float]:
    """Return the trial mass of the second recording [kg m] and its angle [rad]; it goes on the first disk."""
    if not case.is_drawn:
        return TRIAL
    rig = case.rig
    amount = TRIAL_FORCE * rig.disks[0].mass * GRAVITY / rig.plans["default"].fastest ** 2
    return round(amount, 8), TRIAL[1]


@cache
def digest(faults: tuple[str, ...]) -> str:
    """Return a digest of the code and the config that a measurement with these faults depends on."""
    found = hashlib.sha256()
    for path in _sources(faults):
        found.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:12]


def _measure_untripped(case: Case, whole: Path, scratch: Path) -> None:
    """Write the responses of the first drawing of a case that does not trip, its truth, and which one it is."""
    for again in range(MOST_TRIPS):
        try:
            attempt = scratch / str(again)
            attempt.mkdir()
            responses = measure(case, sealed=attempt / "sealed.json", folder=attempt)
            break
        except LimitExceeded:
            if again == MOST_TRIPS - 1:
                raise
            case = draw_again(case)
    whole.mkdir()
    (attempt / "sealed.json").rename(whole / "sealed.json")
    (whole / "again").write_text(str(case.again), encoding="utf-8")
    for i, response in enumerate(responses):
        write_response(whole / f"{i + 1}.response.mcap", response)


def _tracked(recording: RawRecording, path: Path) -> OrderTrackedResponse:
    write_recording(path, recording)
    response = track(read_recording(path))
    path.unlink()
    return replace(response, source=replace(response.source, source=path.stem))


def _with_trial(response: OrderTrackedResponse, known: dict[str, complex]) -> OrderTrackedResponse:
    return replace(response, runs=tuple(replace(run, trial_unbalance=known) for run in response.runs))


def _sources(faults: tuple[str, ...]) -> Iterator[Path]:
    other = {FAULTS / f"{name}.py" for name in fault_names() if name not in faults}
    for folder in FOLDERS:
        yield from (path for path in sorted(folder.rglob("*.py")) if path not in other)
    yield from FILES
