"""Interface of a fault of the plant: one file in this folder, written from the physics of the fault alone.

A fault's module holds `PARAMETERS` (name -> default, SI), `SIZE` (those of them that are all zero if there is no
fault), `RANGE` (the distributions a blind case draws them from; the others keep their default) and any of the hooks of
`Fault`. A range begins where two planes and a trial mass begin to show the fault on the RK4: where lam is about 25 of
the effect that models it (benchmarks/parts/blind/lam.py), if one does; run-out is subtracted with the slow roll and
shows at no size. Dropping a file in here is all it takes. No hook knows of the model a fit uses for the same thing.
"""

import difflib
import importlib
import math
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, cast

import numpy as np

from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.force_laws import Force
from rotorrig.sims.plant.sensors import Chain
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.truth import FaultSpec, Truth

Values = Mapping[str, float]  # every parameter of a fault


class Range(Protocol):
    """Distribution of a parameter over blind cases."""

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for that rig."""
        ...


class Fault(Protocol):
    """Interface of a module in this folder; it leaves out the hooks it has no use for."""

    PARAMETERS: dict[str, float]
    SIZE: tuple[str, ...]
    RANGE: dict[str, Range]

    def deviations(self, rig: RigConfig, truth: Truth, values: Values) -> Truth:
        """Return `truth` with the deviations a truth has words for: a bearing's coefficients, a probe's gain."""
        ...

    def forces(self, rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
        """Return the fault's force laws; whatever they act on becomes a coordinate of the rotor."""
        ...

    def structure(self, rig: RigConfig, truth: Truth, rotor: Rotor, values: Values) -> Rotor:
        """Return `rotor` with other matrices, or with more coordinates behind its own."""
        ...

    def sensors(self, rig: RigConfig, chain: Chain, values: Values) -> Chain:
        """Return the sensor `chain` as the fault leaves it."""
        ...


def fault_names() -> list[str]:
    """Return the names of all faults: the files beside this one."""
    return sorted(m.name for m in pkgutil.iter_modules([str(Path(__file__).parent)]) if m.name != "base")


def check_fault(name: str, parameters: Values) -> None:
    """Raise DataError unless there is a fault of that name with those parameters."""
    if name not in fault_names():
        raise DataError(f"fault '{name}': the plant has none of that name, {_hint(name, fault_names())}")
    known = sorted(load_fault(name).PARAMETERS)
    for parameter in parameters:
        if parameter not in known:
            raise DataError(f"fault '{name}': has no parameter '{parameter}', {_hint(parameter, known)}")


def check_faults(specs: Iterable[FaultSpec]) -> tuple[FaultSpec, ...]:
    """Return `specs` as a tuple. Raises DataError unless each is a fault the plant has, with its parameters."""
    kept = tuple(specs)
    for spec in kept:
        check_fault(spec.name, spec.parameters)
    return kept


def load_fault(name: str) -> Fault:
    """Load the module of that fault."""
    return cast(Fault, importlib.import_module(f"{__package__}.{name}"))


def apply_deviations(rig: RigConfig, truth: Truth) -> Truth:
    """Apply the deviations of its faults to `truth`. Raises DataError as `check_fault` does."""
    for _, hook, values in _hooks(truth, "deviations"):
        truth = hook(rig, truth, values)
    return truth


def collect_forces(rig: RigConfig, truth: Truth) -> tuple[Force, ...]:
    """Collect the force laws of all faults of `truth`. Raises DataError as `check_fault`, or off the shaft."""
    acting: list[Force] = []
    for name, hook, values in _hooks(truth, "forces"):
        own = hook(rig, truth, values)
        for coordinate, _ in (pair for force in own for pair in force.on):
            if not 0.0 <= coordinate.position <= rig.shaft.length:
                raise DataError(
                    f"fault '{name}': acts at {coordinate.position * 1e3:g} mm, "
                    f"want it on the shaft, 0 to {rig.shaft.length * 1e3:g} mm"
                )
        acting += own
    return tuple(acting)


def apply_structure(rig: RigConfig, truth: Truth, rotor: Rotor) -> Rotor:
    """Apply the structural changes of the faults of `truth` to `rotor`."""
    for _, hook, values in _hooks(truth, "structure"):
        rotor = hook(rig, truth, rotor, values)
    return rotor


def apply_sensors(rig: RigConfig, truth: Truth, chain: Chain) -> Chain:
    """Apply the sensor changes of the faults of `truth` to `chain`."""
    for _, hook, values in _hooks(truth, "sensors"):
        chain = hook(rig, chain, values)
    return chain


def _hooks(truth: Truth, hook: str) -> Iterator[tuple[str, Any, dict[str, float]]]:
    """Yield name, hook and values of every fault that is there and has that hook."""
    for spec in truth.faults:
        check_fault(spec.name, spec.parameters)
        module = load_fault(spec.name)
        values = module.PARAMETERS | spec.parameters
        if hasattr(module, hook) and any(values[size] for size in module.SIZE):
            yield spec.name, getattr(module, hook), values


def _hint(name: str, known: list[str]) -> str:
    near = difflib.get_close_matches(name, known, n=1)
    return f"did you mean '{near[0]}'" if near else f"want one of {', '.join(known)}"


@dataclass(frozen=True, slots=True)
class LogUniform:
    """As many below the geometric mean as above: for sizes, which reach down to what nobody could see."""

    low: float
    high: float
    either_sign: bool = False

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        size = math.exp(rng.uniform(math.log(self.low), math.log(self.high)))
        return size * float(rng.choice([-1.0, 1.0])) if self.either_sign else size


@dataclass(frozen=True, slots=True)
class Uniform:
    """Evenly between two values."""

    low: float
    high: float

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        return float(rng.uniform(self.low, self.high))


ANY_PHASE = Uniform(-math.pi, math.pi)


@dataclass(frozen=True, slots=True)
class AnyProbe:
    """The number of one of the rig's probes."""

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a number for that rig."""
        return float(rng.integers(len(rig.probes)))


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of a few values, each as likely."""

    values: tuple[float, ...]

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        return float(rng.choice(self.values))
