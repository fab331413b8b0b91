"""One rig balanced: its runs, the corrections by each method, mounted and run again.

Every run is a sweep of the plant through the config's plan, tracked; the analysis gets responses and the nameplate and
nothing else. What a case keeps of a correction is what the run after showed, and what had been predicted for it.
"""

import cmath
import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.blind.measured import GRAVITY, TRIAL_FORCE
from benchmarks.parts.blind.rigs.drawn import RK4, draw_rig, layout
from benchmarks.parts.blind.run import record
from rotorrig.acquisition.files import read_recording, write_recording
from rotorrig.balancing import Holes, Prediction, Task, balance
from rotorrig.identify import Identification, identify
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.rig import DataError, LimitExceeded
from rotorrig.rig.config import RigConfig, load

Kind = Literal["one plane", "two planes"]
RADIUS = 0.4  # of a disk's diameter, where its holes are
HOLES = 16
MASSES = (0.1, 0.2, 0.5, 1.0)  # of the nameplate's unbalance, at that radius
NOISE = 3.0  # standard deviations of a row, that no correction goes below
MARK = math.pi / 2  # rad, where the trial mass goes
HALVED = 3  # times, a trial mass that trips
MOST_DRAWS = 30

Masses = Mapping[str, complex]  # disk -> kg m


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A rig to balance: two of three with one plane are the RK4, all others are drawn."""

    kind: Kind
    seed: int

    @property
    def name(self) -> str:
        """What it is called: "one plane-6001"."""
        return f"{self.kind}-{self.seed}"

    @property
    def rig(self) -> RigConfig:
        """The nameplate."""
        if self.kind == "one plane" and self.seed % 3:
            return load(RK4)
        wanted = 2 if self.kind == "two planes" else 1
        drawn = (draw_rig(self.seed * MOST_DRAWS + i, planes=2, cross_coupled=False) for i in range(MOST_DRAWS))
        return next(rig for rig in drawn if len(rig.disks) == wanted)


def run_case(case: Case) -> Iterator[dict[str, Any]]:
    """Yield the line of a case in pieces: by trial runs, by the fit alone, with the holes and masses at hand."""
    rig = case.rig
    yield {"rig": "rk4" if rig.name == load(RK4).name else layout(rig)}
    try:
        bench = Bench(rig, case.seed)
        first = bench.sweep({})
        tried = [first, *(bench.sweep_with_trial(disk.name, trial_mass(rig, disk.name)) for disk in rig.disks)]
        planes = tuple(disk.name for disk in rig.disks)
        yield {"by_trial": _mount(bench, tried, Task(planes=planes))}
        if case.kind == "one plane":
            yield {"by_fit": _mount(bench, [first], Task(planes=planes), fit=identify([first]))}
            holes = {disk.name: holes_of(rig, disk.name) for disk in rig.disks}
            yield {"in_holes": _mount(bench, tried, Task(planes=planes, holes=holes))}
    except (LimitExceeded, DataError) as error:
        yield {"error": str(error)}


class Bench:
    """The plant of one seed, swept again and again."""

    def __init__(self, rig: RigConfig, seed: int) -> None:
        self._rig = rig
        self._seed = seed
        self._runs = 0

    def sweep(self, masses: Masses) -> OrderTrackedResponse:
        """Return a run with masses on, tracked. Raises LimitExceeded where the interlock trips."""
        trial = {disk: (abs(u), cmath.phase(u)) for disk, u in masses.items()}
        recording = record(self._rig, seed=self._seed, trial=trial, run=self._runs, guarded=True)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.mcap"
            write_recording(path, recording)
            response = track(read_recording(path))
        self._runs += 1
        source = replace(response.source, source=f"run {self._runs}")
        runs = tuple(replace(run, trial_unbalance=dict(masses)) for run in response.runs)
        return replace(response, source=source, runs=runs)

    def sweep_with_trial(self, disk: str, mass: complex) -> OrderTrackedResponse:
        """Return a run with a trial mass; where it trips, with half of it, and so on. Raises LimitExceeded."""
        for halved in range(HALVED):
            with suppress(LimitExceeded):
                return self.sweep({disk: mass / 2**halved})
        return self.sweep({disk: mass / 2**HALVED})


def trial_mass(rig: RigConfig, disk: str) -> complex:
    """Return a trial mass [kg m]: its force at the highest speed is a tenth of the disk's weight (API 684)."""
    mass = next(d.mass for d in rig.disks if d.name == disk)
    return round(TRIAL_FORCE * mass * GRAVITY / rig.plans["default"].fastest ** 2, 8) * cmath.exp(1j * MARK)


def holes_of(rig: RigConfig, disk: str) -> Holes:
    """Return the holes of a disk and masses that divide the nameplate's unbalance, to two digits."""
    found = next(d for d in rig.disks if d.name == disk)
    radius = RADIUS * found.diameter
    whole = found.unbalance.amount / radius if found.unbalance else 1e-3
    return Holes(count=HOLES, masses=tuple(float(f"{share * whole:.2g}") for share in MASSES), radius=radius)


def _mount(
    bench: Bench, tried: Sequence[OrderTrackedResponse], task: Task, *, fit: Identification | None = None
) -> dict[str, Any]:
    """Balance, mount what it says, run, and return what became of it.

    `factor` is that of the largest amplitudes over all speeds, at the worst probe; `expected` and `held`, by its 95 %
    band, are of the vector that was the largest before: at the critical speed.
    """
    found = balance(tried, task, identification=fit)
    after = bench.sweep({plane: complex(w) for plane, w in zip(found.planes, found.mounted, strict=True)})
    compared = balance(tried, task, identification=fit, after=after).comparison
    assert compared is not None
    predicted, probe = compared.prediction, compared.prediction.probe
    before, left = _largest(predicted.before, probe), _largest(compared.measured, probe)
    critical = int(np.argmax(np.abs(predicted.before)))
    low, high = (end[critical] for end in predicted.band)
    there = float(np.abs(compared.measured[critical]))
    return {
        "factor": float((before / left).min()),
        "at_noise": bool((left < NOISE * _noise(after, predicted)).all()),
        "expected": float(np.abs(predicted.before[critical]) / max(float(np.abs(predicted.after[critical])), 1e-12)),
        "held": bool(low <= there <= high),
        "no_worse": bool(there <= high),
        "inside": compared.share,
        "condition": found.determinacy.condition,
        "left_out": found.left_out,
    }


def _largest(z: NDArray[np.complex128], probe: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the largest amplitude at every probe [m]."""
    return np.array([np.abs(z[probe == p]).max() for p in np.unique(probe)])


def _noise(response: OrderTrackedResponse, like: Prediction) -> NDArray[np.float64]:
    """Return the standard deviation of a row's 1X vector at every probe [m], in the median."""
    at = response.orders.index(1.0)
    variance = response.covariance[:, at].diagonal(axis1=1, axis2=2)
    return np.array([math.sqrt(2 * float(np.nanmedian(variance[:, 2 * p]))) for p in np.unique(like.probe)])
