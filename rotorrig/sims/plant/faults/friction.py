"""Dry friction at a bearing: bristles between housing and seat bend, and slip the sooner the faster it slides.

The bristles' mean bend z follows z' = v - stiffness |v| z / g(v), and pushes back by the stiffness times z; g falls
from the force that breaks the contact loose to that of sliding with the speed, as Stribeck measured (Canudas de Wit,
Olsson, Astrom and Lischinsky, A new model for control of systems with friction, IEEE Trans. Autom. Control 40 (1995)
419, without the bristles' own damping, and with a vector for z). It sticks, creeps before it slides, and never gives
back more than the bristles have stored.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "limit": 0.05,  # N, of sliding
    "stuck_stiffness": 1e5,  # N/m: bends by half a micrometre
}
SIZE = ("limit",)
RANGE = {"limit": LogUniform(3e-3, 0.15)}
STICTION = 1.2  # of the force of sliding, before it slides: steel on oiled steel, an estimate
STRIBECK = 1e-3  # m/s, speed at which most of that is gone: as in the paper's example


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the friction at each bearing sought, at ease where the shaft rests."""
    constants = (values["limit"], values["stuck_stiffness"])
    return tuple(
        Force(on=at(b.position), law=bristles, constants=constants, memory=2, from_rest=True)
        for b in sought_bearings(rig)
    )


@law
def bristles(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = limit, stuck stiffness; remembers the bristles' bend in x and y: backward Euler."""
    speed = math.hypot(motion.vx, motion.vy)
    holds = p[0] * (1.0 + (STICTION - 1.0) * math.exp(-((speed / STRIBECK) ** 2)))
    fades = 1.0 + turn.step * p[1] * speed / holds
    after[0] = (before[0] + turn.step * motion.vx) / fades
    after[1] = (before[1] + turn.step * motion.vy) / fades
    return -p[1] * after[0], -p[1] * after[1]
