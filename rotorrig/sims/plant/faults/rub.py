"""The shaft touches a ring round it that yields and creeps back: it is pushed, and dragged against its rotation.

The ring hangs in rubber, a spring and a dashpot side by side, and has no mass to speak of: pushed aside, it takes
`CREEP` to come back, and a shaft that returns sooner finds it further off (Kelvin and Voigt; rubbing on such a ring:
Jiang and Ulbrich, The physical reason and the analytical condition for the onset of dry whip in rotor-to-stator contact
systems, J. Vib. Acoust. 127 (2005) 594). Friction acts against the slip of the surface, which is the rotation's R W
plus the whirl's own. The ring stands about where the shaft rests.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.truth import Truth

SMOOTH = 2e-2  # m/s, slip below which friction fades, against chatter about zero
CREEP = 5e-4  # s, dashpot over spring: a loss factor of 0.12 at 230 rad/s, as of nitrile rubber (an estimate)

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
    return (Force(on=at(values["position"]), law=touch, constants=constants, memory=2, from_rest=True),)


@law
def touch(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness, gap, friction, radius of the shaft; remembers where the ring is.

    Let go, the ring creeps back to the middle in a step as by backward Euler; the shaft pushes it out of that place.
    """
    slack = 1.0 + turn.step / CREEP
    after[0], after[1] = before[0] / slack, before[1] / slack
    x, y = motion.x - after[0], motion.y - after[1]
    r = math.hypot(x, y)
    if r <= p[1]:
        return 0.0, 0.0
    c, s = x / r, y / r
    after[0] += (r - p[1]) * c
    after[1] += (r - p[1]) * s
    push = p[0] * (1.0 + CREEP / turn.step) * (r - p[1])
    slip = p[3] * turn.omega + c * motion.vy - s * motion.vx
    drag = p[2] * push * math.tanh(slip / SMOOTH)
    return -push * c + drag * s, -push * s - drag * c
