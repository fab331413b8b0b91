"""The simulated rig that stands in for a real one: for a sweep, or until Ctrl-C for another terminal."""

import cmath
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from rotorrig.app.console import out
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.rig.trial_mass import read_trial_mass, trial_unbalance
from rotorrig.sims.plant.faults.base import check
from rotorrig.sims.plant.truth import FaultSpec, Truth, draw, seal, unseal
from rotorrig.sims.wire.launch import BenchPorts, simulated_bench


@dataclass(frozen=True, slots=True, kw_only=True)
class StandIn:
    """The simulated rig to sweep instead of the config's devices."""

    seed: int
    hidden: Path | None = None  # a sealed truth; else one is drawn from the seed
    rate: float = 20.0  # simulated seconds per second, at the most


def stand_in(rig: RigConfig, *, seed: int, hidden: Path | None, rate: float) -> None:
    """Run the simulated rig and say where it is, in the config's own words. Returns at Ctrl-C."""
    with simulated(rig, StandIn(seed=seed, hidden=hidden, rate=rate)) as ports:
        out.print(f'\\[motor] port = "{ports.motor_port}"', highlight=False)
        out.print(f'\\[daq]   port = "{ports.daq_port}"', highlight=False)
        out.print("Put these into a copy of the config and sweep it from another terminal; Ctrl-C ends the rig.")
        try:
            while True:
                time.sleep(1.0)
        except KeyboardInterrupt:
            out.print("ended")


@contextmanager
def simulated(rig: RigConfig, stand_in: StandIn, *, trial: Sequence[str] = ()) -> Iterator[BenchPorts]:
    """Run the simulated rig while the block does, with the trial masses on.

    It has the config's effects by faults of its own of the same names, unless a sealed truth says what it has.
    Raises ConfigError if it has none for one of them, DataError for a trial mass that is not on a disk.
    """
    with tempfile.TemporaryDirectory(prefix="rotorrig-truth-") as scratch:
        hidden = Path(scratch) / "truth.json"
        seal(truth_of(rig, stand_in, trial=trial), hidden)
        with simulated_bench(rig.text, seed=stand_in.seed, hidden=hidden, rate=stand_in.rate) as ports:
            yield ports


def truth_of(rig: RigConfig, stand_in: StandIn, *, trial: Sequence[str] = ()) -> Truth:
    """Return what the simulated rig is, trial masses on. Raises as `simulated` does."""
    added = trial_unbalance(read_trial_mass(mass, rig=rig) for mass in trial)
    masses = {disk: (abs(u), cmath.phase(u)) for disk, u in added.items()}
    if stand_in.hidden is None:
        truth = draw(rig, seed=stand_in.seed, faults=faults_of(rig), trial=masses)
    else:
        truth = unseal(stand_in.hidden)
        truth = replace(truth, trial=draw(rig, seed=truth.seed, trial=masses).trial) if masses else truth
    return replace(truth, run=truth.run + 1) if masses else truth  # the rig as before, in another run


def faults_of(rig: RigConfig) -> tuple[FaultSpec, ...]:
    """Return the plant's faults for the effects of the config. Raises ConfigError for one it has none for."""
    faults = []
    for effect in rig.effects:
        try:
            check(effect.name, effect.parameters)
        except DataError as error:
            raise ConfigError(f"effects: the simulated rig cannot show '{effect.label}': {error}") from error
        faults.append(FaultSpec(name=effect.name, parameters=dict(effect.parameters)))
    return tuple(faults)
