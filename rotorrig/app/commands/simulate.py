"""The simulated rig that stands in for a real one: for a sweep, or until Ctrl-C for another terminal."""

import cmath
import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from rotorrig.app.terminal import out
from rotorrig.rig import ConfigError, DataError
from rotorrig.rig.config import RigConfig, read_trial_mass, trial_unbalance
from rotorrig.sims.plant import FaultSpec, Truth, draw, seal, unseal
from rotorrig.sims.plant.faults import check_fault
from rotorrig.sims.wire import BenchPorts, Message, read_script, simulated_bench


@dataclass(frozen=True, slots=True, kw_only=True)
class StandIn:
    """The simulated rig to sweep instead of the config's devices."""

    seed: int
    hidden: Path | None = None  # a sealed truth; else one is drawn from the seed
    rate: float = 20.0  # simulated seconds per second, at the most
    faults: Path | None = None  # a script of what goes wrong, docs/simulated-rig.md


def stand_in(rig: RigConfig, simulation: StandIn) -> None:
    """Run the simulated rig and say where it is, in the config's own words, and which faults come and go.

    Returns at Ctrl-C.
    """
    with simulated(rig, simulation) as ports:
        for table, keys in (("motor", ports.motor), ("daq", {"driver": "stream"} | ports.daq)):
            for key, value in keys.items():
                out.print(f"\\[{table}] {key} = {json.dumps(value)}", highlight=False)
        out.print("Put these into a copy of the config and sweep it from another terminal; Ctrl-C ends the rig.")
        shown = 0
        try:
            while True:
                messages = ports.console.messages
                for line in messages[shown:]:
                    _show(line)
                shown = len(messages)
                time.sleep(0.2)
        except KeyboardInterrupt:
            out.print("ended")


def _show(message: Message) -> None:
    """Print what became of a fault."""
    if "fault" in message:
        out.print(f"{message['t']:.1f} s: {message['kind']} on {message['on']} {message['event']}", highlight=False)


@contextmanager
def simulated(rig: RigConfig, stand_in: StandIn, *, trial: Sequence[str] = ()) -> Iterator[BenchPorts]:
    """Run the simulated rig while the block does, with the trial masses on.

    It has the config's effects by faults of its own of the same names, unless a sealed truth says what it has.
    Raises ConfigError if it has none for one of them or for a script of faults that cannot be played, DataError for a
    trial mass that is not on a disk.
    """
    if stand_in.faults:
        read_script(stand_in.faults)  # so that its error is the sentence alone
    with tempfile.TemporaryDirectory(prefix="rotorrig-truth-") as scratch:
        hidden = Path(scratch) / "truth.json"
        seal(truth_of(rig, stand_in, trial=trial), hidden)
        with simulated_bench(
            rig.text, seed=stand_in.seed, hidden=hidden, rate=stand_in.rate, faults=stand_in.faults
        ) as ports:
            yield ports


def truth_of(rig: RigConfig, stand_in: StandIn, *, trial: Sequence[str] = ()) -> Truth:
    """Return what the simulated rig is, trial masses on. Raises as `simulated` does."""
    added = trial_unbalance(read_trial_mass(mass, planes=rig.unbalance_planes) for mass in trial)
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
            check_fault(effect.name, effect.parameters)
        except DataError as error:
            raise ConfigError(f"effects: the simulated rig cannot show '{effect.label}': {error}") from error
        faults.append(FaultSpec(name=effect.name, parameters=dict(effect.parameters)))
    return tuple(faults)
