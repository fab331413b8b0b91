"""A bearing in rubber: its loss per cycle goes with the stiffness and hardly at all with the frequency.

A chain of springs each in series with a dashpot, their relaxation times a factor `RATIO` apart, loses nearly the same
per cycle at every frequency within (Biot, J. Appl. Phys. 25 (1954) 1385; Makris, J. Eng. Mech. 123 (1997) 1209
on why a causal law can do no more). Such a rubber stiffens with frequency by 2 / pi of its loss factor per factor
e; the nameplate's stiffness is taken to hold at `frequency`.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings, true_bearing
from rotorrig.sims.plant.truth import Truth

RATIO = 4.0  # between relaxation times; the loss factor then ripples by 1 %
SLOWEST = 1.0  # s, relaxation time
ELEMENTS = 7  # down to 0.24 ms: from 1 Hz to 200 Hz the loss factor is as stated within 10 %

PARAMETERS: dict[str, float] = {
    "loss_factor": 0.02,  # of the bearing
    "frequency": 37.0,  # Hz, where the stiffness is the nameplate's
}
SIZE = ("loss_factor",)
RANGE = {"loss_factor": LogUniform(2e-3, 0.06)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the lossy part of each bearing sought."""
    share = values["loss_factor"] * 2.0 / math.pi * math.log(RATIO)  # of the stiffness, per element of the chain
    wt = [math.tau * values["frequency"] * SLOWEST / RATIO**i for i in range(ELEMENTS)]
    stiffened = share * sum(x * x / (1.0 + x * x) for x in wt)
    laws = [(b.position, true_bearing(truth, b)) for b in sought_bearings(rig)]
    return tuple(
        Force(
            on=at(position),
            law=chain,
            constants=(share * b.kxx, share * b.kyy, stiffened * b.kxx, stiffened * b.kyy),
            memory=2 + 2 * ELEMENTS,
            from_rest=True,
        )
        for position, b in laws
    )


@law
def chain(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness of an element in x and y, and what all stiffen.

    It remembers x, y and where each dashpot stands, which follows z' = (x - z) / relaxation time: trapezoidal rule.
    """
    after[0], after[1] = motion.x, motion.y
    fx, fy = p[2] * motion.x, p[3] * motion.y
    relaxation = SLOWEST
    for i in range(ELEMENTS):
        a = turn.step / (2.0 * relaxation)
        relaxation /= RATIO
        zx, zy = 2 + 2 * i, 3 + 2 * i
        after[zx] = ((1.0 - a) * before[zx] + a * (before[0] + motion.x)) / (1.0 + a)
        after[zy] = ((1.0 - a) * before[zy] + a * (before[1] + motion.y)) / (1.0 + a)
        fx -= p[0] * (motion.x - after[zx])
        fy -= p[1] * (motion.y - after[zy])
    return fx, fy
