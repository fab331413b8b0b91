"""`rotor simulate`: a simulated rig on real ports, during a sweep or until Ctrl-C."""

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
from rotorrig.sims import plant
from rotorrig.sims.wire import BenchPorts, Message, read_script, simulated_bench


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedRig:
    """Options of the simulated rig that replaces the config's devices."""

    seed: int
    hidden: Path | None = None  # sealed truth; None: drawn from the seed
    rate: float = 20.0  # simulated seconds per second, at most
    faults: Path | None = None  # fault script, docs/simulated-rig.md
    before: int = 0  # runs of the rig before this one: each strays a little from the others


def run_until_interrupted(rig: RigConfig, simulation: SimulatedRig) -> None:
    """Run the simulated rig until Ctrl-C; print its ports as config keys, and its faults as they begin and end."""
    with run_simulated_rig(rig, simulation) as ports:
        for table, keys in (("motor", ports.motor), ("daq", {"driver": "stream"} | ports.daq)):
            for key, value in keys.items():
                out.print(f"[{table}] {key} = {json.dumps(value)}", highlight=False)
        out.print("Put these keys into a copy of the config and sweep it from another terminal; Ctrl-C ends the rig.")
        shown = 0
        try:
            while True:
                messages = ports.console.messages
                for message in messages[shown:]:
                    _show_fault(message)
                shown = len(messages)
                time.sleep(0.2)
        except KeyboardInterrupt:
            out.print("ended")


def _show_fault(message: Message) -> None:
    """Print the begin or end of a scripted fault."""
    if "fault" in message:
        out.print(f"{message['t']:.1f} s: {message['kind']} on {message['on']} {message['event']}", highlight=False)


@contextmanager
def run_simulated_rig(rig: RigConfig, simulation: SimulatedRig, *, trial: Sequence[str] = ()) -> Iterator[BenchPorts]:
    """Run the simulated rig within the block, with the trial masses on.

    The plant gets a fault for each of the config's effects, unless a sealed truth is given. Raises ConfigError for an
    effect without such a fault or an invalid fault script, DataError for a trial mass that is not on a disk.
    """
    if simulation.faults:
        read_script(simulation.faults)  # so that its error is the sentence alone
    with tempfile.TemporaryDirectory(prefix="rotorrig-truth-") as scratch:
        hidden = Path(scratch) / "truth.json"
        plant.seal(truth_of(rig, simulation, trial=trial), hidden)
        with simulated_bench(
            rig.text, seed=simulation.seed, hidden=hidden, rate=simulation.rate, faults=simulation.faults
        ) as ports:
            yield ports


def truth_of(rig: RigConfig, simulation: SimulatedRig, *, trial: Sequence[str] = ()) -> plant.Truth:
    """Return the truth of the simulated rig, trial masses on. Raises as `run_simulated_rig` does."""
    added = trial_unbalance(read_trial_mass(mass, planes=rig.unbalance_planes) for mass in trial)
    masses = {disk: (abs(u), cmath.phase(u)) for disk, u in added.items()}
    if simulation.hidden is None:
        truth = plant.draw(rig, seed=simulation.seed, faults=faults_of(rig), trial=masses)
    else:
        truth = plant.unseal(simulation.hidden)
        truth = replace(truth, trial=plant.draw(rig, seed=truth.seed, trial=masses).trial) if masses else truth
    return replace(truth, run=truth.run + (simulation.before or bool(masses)))  # the rig as before, in another run


def faults_of(rig: RigConfig) -> tuple[plant.FaultSpec, ...]:
    """Return the plant's faults for the effects of the config. Raises ConfigError for an effect without one."""
    from rotorrig.sims.plant.faults import check_fault  # takes half a second to import

    faults = []
    for effect in rig.effects:
        try:
            check_fault(effect.name, effect.parameters)
        except DataError as error:
            raise ConfigError(f"effects: the simulated rig cannot show '{effect.label}': {error}") from error
        faults.append(plant.FaultSpec(name=effect.name, parameters=dict(effect.parameters)))
    return tuple(faults)
