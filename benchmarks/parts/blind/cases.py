"""The cases of the blind benchmark: which rig, with what hidden in it, measured how.

A case is a design, the faults it hides and a seed. The seed draws the rig within its tolerances, and the sizes of the
faults from the range that each of them states. All of it goes into a sealed file before the first sweep; what is handed
on is the tracked responses and nothing else.

Designs: P1 has one plane of two probes, slow roll, speed-up and coast-down through the first critical speed; P2 has
two planes, and a second recording of the same rig with a known trial mass. "fast" is P1 swept three times as fast: a
third of the rows, for tests.
"""

import hashlib
import json
import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benchmarks.parts.blind.names import ANSWERS
from benchmarks.parts.blind.run import record
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording, write_recording
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.rig.config import RigConfig, load
from rotorrig.rig.config.description import from_si
from rotorrig.sims.plant import FaultSpec, draw, seal
from rotorrig.sims.plant.draw import draw_fault
from rotorrig.sims.plant.faults.base import fault_names

CONFIG = Path(__file__).parents[3] / "configs/rk4.toml"
TRIAL = {"disk": (12e-6, math.pi / 2)}  # kg m, rad from the keyphasor mark in the sense of rotation
FIRST_PLANE = ("1x", "1y")
HURRY = 3.0
HEALTHY = "healthy"

Design = Literal["P1", "P2", "fast"]
DESIGNS: tuple[Design, ...] = ("P1", "P2")
RUNS: Mapping[Design, int] = {"P1": 1, "P2": 2, "fast": 1}  # recordings of the rig
Kind = Literal["healthy", "single", "pair", "outsider"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One simulated rig and how it is measured."""

    design: Design
    faults: tuple[str, ...] = ()  # none: healthy
    seed: int

    @property
    def name(self) -> str:
        """What its file is called: "bow-3"."""
        return f"{'+'.join(self.faults) or HEALTHY}-{self.seed}"

    @property
    def kind(self) -> Kind:
        """What is asked of the diagnosis."""
        if not self.faults:
            return "healthy"
        if not ANSWERS.keys() >= set(self.faults):
            return "outsider"
        return "single" if len(self.faults) == 1 else "pair"

    @property
    def plant_seed(self) -> int:
        """The seed of the rig, of every case another one; 40 bits keep it apart from seeds that were tuned on."""
        return int.from_bytes(hashlib.sha256(f"{self.design} {self.name}".encode()).digest()[:5]) | 1 << 39

    @property
    def rig(self) -> RigConfig:
        """The nameplate."""
        return nameplate(self.design)


def cases(
    design: Design, *, seeds: int, healthy: int, pairs: int, effects: Collection[str] = (), first: int = 0
) -> Iterator[Case]:
    """Yield `seeds` cases of every fault, then so many healthy ones and pairs; of `effects` alone if any are given."""
    wanted = set(effects) or {*modelled(), *outsiders(), HEALTHY}
    for fault in (*modelled(), *outsiders()):
        if fault in wanted:
            for seed in range(first, first + seeds):
                yield Case(design=design, faults=(fault,), seed=seed)
    if HEALTHY in wanted:
        for seed in range(first, first + healthy):
            yield Case(design=design, seed=seed)
    known = [fault for fault in modelled() if fault in wanted]
    for seed in range(first, first + pairs if len(known) > 1 else first):
        one, other = np.random.default_rng([seed, DESIGNS.index(design)]).choice(len(known), 2, replace=False)
        yield Case(design=design, faults=(known[one], known[other]), seed=seed)


def modelled() -> tuple[str, ...]:
    """Return the names of the faults that have an effect for a counterpart."""
    return tuple(name for name in fault_names() if name in ANSWERS)


def outsiders() -> tuple[str, ...]:
    """Return the names of the faults that no effect of sims/effects models."""
    return tuple(name for name in fault_names() if name not in ANSWERS)


def sizes(case: Case) -> tuple[FaultSpec, ...]:
    """Draw the parameters of the faults of a case."""
    return tuple(draw_fault(case.rig, name, seed=case.plant_seed, runs=RUNS[case.design]) for name in case.faults)


def measure(
    case: Case, *, sealed: Path, folder: Path, faults: tuple[FaultSpec, ...] | None = None
) -> list[OrderTrackedResponse]:
    """Seal the truth of a case into a file, sweep its rig and return the tracked responses; `faults` as drawn if None.

    Recordings go through files in `folder`. A response names neither its seed nor its case.
    """
    rig, seed = case.rig, case.plant_seed
    hidden = sizes(case) if faults is None else faults
    seal(draw(rig, seed=seed, faults=hidden), sealed)
    responses = [_tracked(record(rig, seed=seed, faults=hidden), folder / "run 1.mcap")]
    if case.design == "P2":
        again = record(rig, seed=seed, faults=hidden, trial=TRIAL, run=1)
        responses.append(_with_trial(_tracked(again, folder / "run 2.mcap")))
    return responses


def files(case: Case, folder: Path) -> tuple[Path, Path]:
    """Return where the diagnosis of a case and its sealed truth are kept."""
    place = folder / case.design
    return place / f"{case.name}.json", place / f"{case.name}.sealed.json"


def write_whole(path: Path, table: Mapping[str, Any]) -> None:
    """Write a JSON file that is there whole or not at all."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(table), encoding="utf-8")
    part.replace(path)


@cache
def nameplate(design: Design) -> RigConfig:
    """Return the config of a design: configs/rk4.toml, without the second plane for all but P2."""
    rig = load(CONFIG)
    if design == "P2":
        return rig
    table = rig.model_dump(mode="json")
    table["probes"] = [probe for probe in table["probes"] if probe["name"] in FIRST_PLANE]
    if design == "fast":
        plan = table["plans"]["default"]
        plan["ramp"] *= HURRY
        plan["slow_roll_time"] *= 0.6
    return from_si(table, where="configs/rk4.toml with one plane")


def _tracked(recording: RawRecording, path: Path) -> OrderTrackedResponse:
    write_recording(path, recording)
    response = track(read_recording(path))
    return replace(response, source=replace(response.source, source=path.stem))


def _with_trial(response: OrderTrackedResponse) -> OrderTrackedResponse:
    known = {disk: amount * complex(math.cos(angle), math.sin(angle)) for disk, (amount, angle) in TRIAL.items()}
    return replace(response, runs=tuple(replace(run, trial_unbalance=known) for run in response.runs))
