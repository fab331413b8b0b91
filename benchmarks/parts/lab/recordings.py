"""Recordings of a lab: short sweeps of simulated RK4s, each with a hidden truth and noise of its own, made once."""

import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from benchmarks.parts.blind.run import record
from benchmarks.parts.jobs import in_parallel
from rotorrig.acquisition.files import write_recording
from rotorrig.rig.config import RigConfig, parse

ROOT = Path(__file__).parents[3]
MADE = ROOT / ".cache/lab/recordings"
FIRST_SEED = 20_000  # no other benchmark's
#: a run-up and coast-down in 35 s each instead of minutes: 700,000 samples of five channels, 2.4 MB
BRISK = (('ramp = "30 rpm/s"', 'ramp = "240 rpm/s"'), ('time = "10 s"', 'time = "3 s"'))


@cache
def brisk_rig() -> RigConfig:
    """Return the RK4 with a quick ramp and a short slow roll."""
    text = (ROOT / "configs/rk4.toml").read_text(encoding="utf-8")
    for old, new in BRISK:
        assert old in text
        text = text.replace(old, new)
    return parse(text, where="brisk rk4.toml")


def make_recordings(number: int, *, workers: int) -> list[Path]:
    """Return that many recordings; those that are not there are made, three seconds of a processor each."""
    MADE.mkdir(parents=True, exist_ok=True)
    paths = [MADE / f"{FIRST_SEED + i}.mcap" for i in range(number)]
    in_parallel(_make, [path for path in paths if not path.exists()], workers=workers)
    return paths


def link_recordings(folder: Path, paths: Sequence[Path]) -> Path:
    """Return a new folder with these recordings: links, so that a lab of its own is made beside them."""
    folder.mkdir(parents=True)
    for path in paths:
        os.link(path, folder / path.name)
    return folder


def _make(path: Path) -> None:
    write_recording(path, record(brisk_rig(), seed=int(path.stem)), overwrite=True)
