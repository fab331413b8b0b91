"""The cases of the blind benchmark: which rig, with what hidden in it, measured how.

A case is a design, what it hides and a seed. The seed draws the rig within its tolerances, and the sizes of faults from
the range that each of them states. Hidden are one fault or two, one that no effect models (an outsider), a dimension
that is not the nameplate's (a deviant), or nothing but what every rig has (healthy). Two cases of three are of
configs/rk4.toml, the third of a rig of its own (rigs/drawn.py).

Designs: P1 has one plane of two probes, slow roll, speed-up and coast-down through the first critical speed; P2 has
two planes, and a second recording of the same rig with a known trial mass. "day" is for tests: two planes of a drawn
rig, and one recording, swept three times as fast, which leaves a third of the rows.

Seeds 0 to 99 are for development. Those of an examination begin at 1000 times its number: nobody has run them.
"""

import hashlib
import zlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np

from benchmarks.parts.blind.names import ANSWERS
from benchmarks.parts.blind.rigs.deviants import DEVIANTS, Deviation, put_together
from benchmarks.parts.blind.rigs.drawn import RK4, draw_rig
from benchmarks.parts.blind.rigs.fault_sizes import fault_of
from rotorrig.rig.config import RigConfig, load
from rotorrig.rig.config.description import from_si
from rotorrig.sims.plant import FaultSpec
from rotorrig.sims.plant.faults.base import fault_names
from rotorrig.sims.plant.truth import Geometry

FIRST_PLANE = ("1x", "1y")
HURRY = 3.0
HEALTHY = "healthy"
DEVELOPMENT = 100  # seeds that may be looked at
EXAMINATION = 1000  # first seed of an examination, times its number
#: faults that no effect models and that an examination hides: fixed, as the kept results are of these. Faults that came
#: later are for the search for a missing force alone (parts/discovery/wanted.py).
OUTSIDERS = ("loose_disk", "loose_pedestal", "probe_curvature", "slipping_coupling")
OF_THE_BEARING = {"cross_stiffness", "skew_stiffness"}  # faults that are none where all coefficients are sought

Design = Literal["P1", "P2", "day"]
DESIGNS: tuple[Design, ...] = ("P1", "P2")
RUNS: Mapping[Design, int] = {"P1": 1, "P2": 2, "day": 1}  # recordings of the rig
PLANES: Mapping[Design, int] = {"P1": 1, "P2": 2, "day": 2}  # of probes
Kind = Literal["healthy", "single", "pair", "outsider", "deviant"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One simulated rig and how it is measured."""

    design: Design
    faults: tuple[str, ...] = ()
    deviant: str = ""  # which dimension is not the nameplate's; without it and without faults: healthy
    seed: int
    again: int = 0  # times it was drawn before and its sweep tripped

    @property
    def name(self) -> str:
        """What it is called: "bow-3"."""
        return f"{'+'.join(self.faults) or self.deviant or HEALTHY}-{self.seed}"

    @property
    def kind(self) -> Kind:
        """What is asked of the diagnosis."""
        if self.deviant:
            return "deviant"
        if not self.faults:
            return "healthy"
        if not ANSWERS.keys() >= set(self.faults):
            return "outsider"
        return "single" if len(self.faults) == 1 else "pair"

    @property
    def plant_seed(self) -> int:
        """The seed of the rig, of every case another one; 40 bits keep it apart from seeds that were tuned on."""
        drawn = f"{self.design} {self.name}" + (f" again {self.again}" if self.again else "")
        return int.from_bytes(hashlib.sha256(drawn.encode()).digest()[:5]) | 1 << 39

    @property
    def is_drawn(self) -> bool:
        """Whether the rig is one of its own: in every third case of a fault."""
        if self.design == "day":
            return True
        hidden = f"{'+'.join(self.faults)}{self.deviant}"
        return (self.seed + zlib.crc32(hidden.encode())) % 3 == 0

    @property
    def rig(self) -> RigConfig:
        """The nameplate."""
        if not self.is_drawn:
            return nameplate(self.design)
        all_sought = False if OF_THE_BEARING & set(self.faults) else None
        rig = draw_rig(self.plant_seed, planes=PLANES[self.design], cross_coupled=all_sought)
        return _hurry(rig) if self.design == "day" else rig

    @property
    def geometry(self) -> tuple[Geometry, tuple[Deviation, ...]]:
        """How the rig was put together, and where that is not what the nameplate says."""
        return put_together(self.rig, self.deviant, seed=self.plant_seed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """Numbers of cases of one design."""

    seeds: int  # of every modelled fault
    healthy: int = 0
    outsiders: int = 0  # in all
    pairs: int = 0
    deviants: int = 0  # in all


EXTENTS: Mapping[Design, Extent] = {
    "P2": Extent(seeds=10, healthy=400, outsiders=40, pairs=40, deviants=40),
    "P1": Extent(seeds=5, healthy=100),
}


def cases(design: Design, extent: Extent, *, hidden: Collection[str] = (), first: int = 0) -> Iterator[Case]:
    """Yield the cases of a design, seeds from `first` on; of what is `hidden` alone if any are given."""
    wanted = set(hidden) or {*modelled(), *OUTSIDERS, *DEVIANTS, HEALTHY}
    for fault in modelled():
        if fault in wanted:
            yield from (Case(design=design, faults=(fault,), seed=first + i) for i in range(extent.seeds))
    strange = [name for name in OUTSIDERS if name in wanted]
    for i in range(extent.outsiders if strange else 0):
        yield Case(design=design, faults=(strange[i % len(strange)],), seed=first + i // len(strange))
    wrong = [name for name in DEVIANTS if name in wanted]
    for i in range(extent.deviants if wrong else 0):
        yield Case(design=design, deviant=wrong[i % len(wrong)], seed=first + i // len(wrong))
    if HEALTHY in wanted:
        yield from (Case(design=design, seed=first + i) for i in range(extent.healthy))
    known = [fault for fault in modelled() if fault in wanted]
    for seed in range(first, first + extent.pairs if len(known) > 1 else first):
        one, other = np.random.default_rng([seed, DESIGNS.index(design)]).choice(len(known), 2, replace=False)
        yield Case(design=design, faults=(known[one], known[other]), seed=seed)


def shuffle(wanted: Collection[Case], *, attempt: int) -> list[Case]:
    """Return the cases in the random order of that attempt: as far as a run comes, it is a fair sample."""
    ordered = list(wanted)
    return [ordered[i] for i in np.random.default_rng([attempt, zlib.crc32(b"order")]).permutation(len(ordered))]


def modelled() -> tuple[str, ...]:
    """Return the names of the faults that have an effect for a counterpart."""
    return tuple(name for name in fault_names() if name in ANSWERS)


def sizes(case: Case) -> tuple[FaultSpec, ...]:
    """Draw the parameters of the faults of a case."""
    rig, runs = case.rig, RUNS[case.design]
    return tuple(fault_of(rig, name, seed=case.plant_seed, runs=runs) for name in case.faults)


def draw_again(case: Case) -> Case:
    """Return the case that takes the place of one whose sweep tripped: another rig, other sizes."""
    return replace(case, again=case.again + 1)


@cache
def nameplate(design: Design) -> RigConfig:
    """Return the RK4 of a design: configs/rk4.toml, without the second plane for all but P2."""
    rig = load(RK4)
    if design == "P2":
        return rig
    table = rig.model_dump(mode="json")
    table["probes"] = [probe for probe in table["probes"] if probe["name"] in FIRST_PLANE]
    return from_si(table, where="configs/rk4.toml with one plane")


def _hurry(rig: RigConfig) -> RigConfig:
    """Return the rig with a plan that is through in a third of the time."""
    table = rig.model_dump(mode="json")
    table["plans"]["default"]["ramp"] *= HURRY
    table["plans"]["default"]["slow_roll_time"] *= 0.6
    return from_si(table, where=f"{rig.name}, swept fast")
