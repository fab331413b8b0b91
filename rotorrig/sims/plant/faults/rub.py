"""The shaft touches a ring round it: it is pushed back, and dragged against its rotation by friction.

Beyond the gap a normal force grows with the depth, and its friction acts against the slip of the surface, which is the
rotation's R W plus the whirl's own (Muszynska, Rotordynamics (2005), ch. 5). The ring stands about where the shaft
rests.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.truth import Truth

SMOOTH = 2e-2  # m/s, slip below which friction fades, against chatter about zero

PARAMETERS: dict[str, float] = {
    "stiffness": 3e4,  # N/m of the ring; zero: there is none
    "gap": 2e-4,  # m, radial
    "friction": 0.05,  # PTFE or oiled bronze; more of it, on a stiffer ring, whips the shaft backward beyond all bounds
    "position": 0.32,  # m from the coupling
}
SIZE = ("stiffness",)
RANGE = {"stiffness": LogUniform(2e3, 5e4), "gap": Uniform(1e-4, 4e-4), "friction": Uniform(0.02, 0.06)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the push and drag of the ring."""
    constants = (values["stiffness"], values["gap"], values["friction"], rig.shaft.diameter / 2)
    return (Force(on=at(values["position"]), law=touch, constants=constants, from_rest=True),)


@law
def touch(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness, gap, friction, radius of the shaft."""
    r = math.hypot(motion.x, motion.y)
    if r <= p[1]:
        return 0.0, 0.0
    c, s = motion.x / r, motion.y / r
    push = p[0] * (r - p[1])
    slip = p[3] * turn.omega + c * motion.vy - s * motion.vx
    drag = p[2] * push * math.tanh(slip / SMOOTH)
    return -push * c + drag * s, -push * s - drag * c
