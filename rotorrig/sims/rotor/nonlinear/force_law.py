"""Force law: a force at one place of the shaft that depends nonlinearly on the motion there: a stop, a rub, friction.

The force is a small numba function of the place's position and velocity, so that what evaluates it a million times is
compiled once for all of them: it takes a pointer to the function.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numba import types
from numba.core.dispatcher import Dispatcher
from numpy.typing import NDArray

from rotorrig.rig import ConfigError

Force = Callable[[float, float, float, float, NDArray[np.float64]], tuple[float, float]]

_F8 = types.float64
SIGNATURE = types.UniTuple(_F8, 2)(_F8, _F8, _F8, _F8, types.Array(_F8, 1, "C"))
POINTER = types.FunctionType(SIGNATURE)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceLaw:
    """The force (fx, fy) [N] on the shaft at x, y [m] of a place moving at vx, vy [m/s].

    `static` is where the place lies at rest without this force: its sag, say, in the clearance of a stop. The mean of
    the force shifts it from there. A law that turns with the shaft finds the cosine and sine of the shaft's angle, from
    the keyphasor's mark, in the last two of the constants it is handed; two of its own stand there for angle zero.

    With `overtones` the motion it is evaluated on has those that it causes itself, which takes twice the time. A law
    that goes with loads of 2X and 3X is without: what these do is not in that motion either.
    """

    rows: NDArray[np.float64]  # (2, dof) read x and y of the place, or of its motion relative to another
    force: Force  # (x, y, vx, vy, constants) -> (fx, fy), decorated with numba.njit(cache=True)
    constants: NDArray[np.float64]  # (n,) handed to it
    static: NDArray[np.float64] = field(default_factory=lambda: np.zeros(2))  # (2,) m
    overtones: bool = True

    def __post_init__(self) -> None:
        """Compile the force for its one signature. Raises ConfigError if it is not a numba function."""
        if not isinstance(self.force, Dispatcher):
            raise ConfigError(f"force of a law is {self.force!r}, want a function decorated with numba.njit")
        if SIGNATURE.args not in self.force.overloads:
            self.force.compile(SIGNATURE)
        self.force.disable_compile()  # numba then passes it as a pointer, instead of compiling the caller for it anew
