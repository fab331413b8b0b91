"""What a fault of the plant is: one file in this folder, written from the physics of the fault alone.

A fault's module holds `PARAMETERS` (name -> default, SI), `SIZE` (those of them that are all zero if there is no
fault), `RANGE` (where a blind case draws them from; the others keep their default) and any of the hooks of `Fault`.
Dropping a file in here is all it takes. No hook knows of the model a fit uses for the same thing.
"""

import difflib
import importlib
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Protocol, cast

from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant import faults
from rotorrig.sims.plant.chain import Chain
from rotorrig.sims.plant.force_laws import Force
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.sizes import Range
from rotorrig.sims.plant.truth import FaultSpec, Truth

Values = Mapping[str, float]  # every parameter of a fault


class Fault(Protocol):
    """What a module in this folder offers; it leaves out the hooks it has no use for."""

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


def names() -> list[str]:
    """Return the names of all faults: the files beside this one."""
    return sorted(m.name for m in pkgutil.iter_modules(faults.__path__) if m.name != "base")


def check(name: str, parameters: Values) -> None:
    """Raise DataError unless there is a fault of that name with those parameters."""
    if name not in names():
        raise DataError(f"fault '{name}': the plant has none of that name, {_hint(name, names())}")
    known = sorted(fault(name).PARAMETERS)
    for parameter in parameters:
        if parameter not in known:
            raise DataError(f"fault '{name}': has no parameter '{parameter}', {_hint(parameter, known)}")


def check_faults(specs: Iterable[FaultSpec]) -> tuple[FaultSpec, ...]:
    """Return `specs` as a tuple. Raises DataError unless each is a fault the plant has, with its parameters."""
    kept = tuple(specs)
    for spec in kept:
        check(spec.name, spec.parameters)
    return kept


def fault(name: str) -> Fault:
    """Return the module of that fault."""
    return cast(Fault, importlib.import_module(f"{faults.__name__}.{name}"))


def deviated(rig: RigConfig, truth: Truth) -> Truth:
    """Return `truth` with what its faults change of it. Raises DataError as `check` does."""
    for _, hook, values in _hooks(truth, "deviations"):
        truth = hook(rig, truth, values)
    return truth


def forces(rig: RigConfig, truth: Truth) -> tuple[Force, ...]:
    """Return the force laws of all faults of `truth`. Raises DataError as `check`, and on a place off the shaft."""
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


def restructured(rig: RigConfig, truth: Truth, rotor: Rotor) -> Rotor:
    """Return `rotor` with what the faults of `truth` change of its matrices."""
    for _, hook, values in _hooks(truth, "structure"):
        rotor = hook(rig, truth, rotor, values)
    return rotor


def misread(rig: RigConfig, truth: Truth, chain: Chain) -> Chain:
    """Return the sensor `chain` with what the faults of `truth` change of it."""
    for _, hook, values in _hooks(truth, "sensors"):
        chain = hook(rig, chain, values)
    return chain


def _hooks(truth: Truth, hook: str) -> Iterator[tuple[str, Any, dict[str, float]]]:
    """Yield name, hook and values of every fault that is there and has that hook."""
    for spec in truth.faults:
        check(spec.name, spec.parameters)
        module = fault(spec.name)
        values = module.PARAMETERS | spec.parameters
        if hasattr(module, hook) and any(values[size] for size in module.SIZE):
            yield spec.name, getattr(module, hook), values


def _hint(name: str, known: list[str]) -> str:
    near = difflib.get_close_matches(name, known, n=1)
    return f"did you mean '{near[0]}'" if near else f"want one of {', '.join(known)}"
