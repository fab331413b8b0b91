"""A bearing in filled rubber: part of its loss is friction within the filler, part is viscous.

An elastic part, a friction part and a viscous part side by side (Berg, A non-linear rubber spring model for rail
vehicle dynamics analysis, Vehicle System Dynamics 30 (1998) 197). The friction is Bouc's and Wen's hysteresis of first
order, z' = v - |v| z / reach (Wen, Method for random vibration of hysteretic systems, J. Eng. Mech. Div. ASCE 102
(1976) 249, with a vector for z), the viscous part a spring in series with a dashpot. On a circular whirl of radius r
the one stores k / (1 + q^2) and loses k q / (1 + q^2), q = r / reach; the other likewise with q = 1 / (relaxation time
* w). So the loss depends on amplitude as well as on frequency, and is the one stated, and the stiffness the
nameplate's, at `REACH` and `frequency`.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "loss_factor": 0.02,  # of the bearing
    "frequency": 37.0,  # Hz, where the viscous part is half way from soft to stiff
}
SIZE = ("loss_factor",)
RANGE = {"loss_factor": LogUniform(0.04, 0.15)}
REACH = 5e-5  # m, motion at which most of the filler has come loose: an estimate, for rubber of 1 mm at 5 % strain
FRICTION = 0.5  # of the loss; the rest is viscous


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the lossy part of each bearing sought."""
    filler, viscous = 2.0 * FRICTION * values["loss_factor"], 2.0 * (1.0 - FRICTION) * values["loss_factor"]
    relaxation = 1.0 / (math.tau * values["frequency"])
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(
        Force(
            on=at(position), law=rubber, constants=(b.kxx, b.kyy, filler, viscous, relaxation), memory=6, from_rest=True
        )
        for position, b in laws
    )


@law
def rubber(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness in x and y, shares of filler and viscous part, relaxation time.

    It remembers x, y, the filler's z, by backward Euler, and where the dashpot stands, by the trapezoidal rule.
    """
    after[0], after[1] = motion.x, motion.y
    dx, dy = motion.x - before[0], motion.y - before[1]
    fades = 1.0 + math.hypot(dx, dy) / REACH
    after[2], after[3] = (before[2] + dx) / fades, (before[3] + dy) / fades
    a = turn.step / (2.0 * p[4])
    after[4] = ((1.0 - a) * before[4] + a * (before[0] + motion.x)) / (1.0 + a)
    after[5] = ((1.0 - a) * before[5] + a * (before[1] + motion.y)) / (1.0 + a)
    # each part is stiff by half its share at the figures stated; that half is the nameplate's
    half = (p[2] + p[3]) / 2.0
    fx = p[2] * after[2] + p[3] * (motion.x - after[4]) - half * motion.x
    fy = p[2] * after[3] + p[3] * (motion.y - after[5]) - half * motion.y
    return -p[0] * fx, -p[1] * fy
