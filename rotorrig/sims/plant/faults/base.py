"""What a fault of the plant is: force laws at places on the shaft, one file per fault in this folder.

A fault's module holds `PARAMETERS` (name -> default, SI) and `forces(rig, values)`; dropping a file in here is all it
takes. The laws come from the physics of the fault, never from the model a fit uses for it.
"""

import difflib
import importlib
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, cast

from numba import njit, types

from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant import faults

#: fx, fy [N] from shaft angle [rad] and speed [rad/s], both signed (x to y positive), the place's deflection x, y [m]
#: and velocity vx, vy [m/s], and the law's own constants
LAW = types.UniTuple(types.float64, 2)(*[types.float64] * 6, types.float64[::1])


@dataclass(frozen=True, slots=True, kw_only=True)
class PointForce:
    """A force law acting on the shaft at one place."""

    position: float  # m from the coupling
    law: Callable[..., tuple[float, float]]  # made by `law`
    constants: tuple[float, ...]


class Fault(Protocol):
    """What a module in this folder offers."""

    PARAMETERS: dict[str, float]

    def forces(self, rig: RigConfig, values: Mapping[str, float]) -> tuple[PointForce, ...]:
        """Return the forces of the fault on `rig`; `values` holds every parameter."""
        ...


def law(function: Callable[..., tuple[float, float]]) -> Any:
    """Compile a force law (decorator); the integrator calls it in every iteration of every step."""
    return njit(LAW, cache=True)(function)


def names() -> list[str]:
    """Return the names of all faults: the files beside this one."""
    return sorted(m.name for m in pkgutil.iter_modules(faults.__path__) if m.name != "base")


def forces(rig: RigConfig, name: str, parameters: Mapping[str, float]) -> tuple[PointForce, ...]:
    """Return the forces of fault `name` on `rig`, defaults filled in. Raises DataError as `check` does."""
    check(name, parameters)
    module = _module(name)
    return module.forces(rig, module.PARAMETERS | dict(parameters))


def check(name: str, parameters: Mapping[str, float]) -> None:
    """Raise DataError unless there is a fault of that name with those parameters."""
    if name not in names():
        raise DataError(f"fault '{name}': the plant has none of that name, {_hint(name, names())}")
    known = sorted(_module(name).PARAMETERS)
    for parameter in parameters:
        if parameter not in known:
            raise DataError(f"fault '{name}': has no parameter '{parameter}', {_hint(parameter, known)}")


def _module(name: str) -> Fault:
    return cast(Fault, importlib.import_module(f"{faults.__name__}.{name}"))


def _hint(name: str, known: list[str]) -> str:
    near = difflib.get_close_matches(name, known, n=1)
    return f"did you mean '{near[0]}'" if near else f"want one of {', '.join(known)}"
