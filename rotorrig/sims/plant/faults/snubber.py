"""A snubber ring that the shaft touches where it was to pass free: a second support, soft, that begins beyond a gap.

The ring hangs on springs, has no mass to speak of and is oiled: it pushes back square to its surface, k (r - gap) from
its centre outwards, and does not drag (Karpenko, Wiercigroch, Pavlovskaia and Neilson, Piecewise approximate analytical
solutions for a Jeffcott rotor with a snubber ring, Int. J. Mech. Sci. 44 (2002) 475). Nobody centres it on the sagged
shaft: it stands off to one side, where it is touched first, so that it pushes once per turn before it pushes all round.
Of `rub` it differs by that, by having no friction and by springs that follow at once where rubber creeps back;
`clearance` is a bearing that lets go within a gap, this is none, at a place that has no bearing.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "stiffness": 1e3,  # N/m of the ring's springs, against 45 kN/m of the shaft; zero: there is none
    "gap": 1e-4,  # m, radial
    "offset": 0.5,  # of the gap, by which the ring is off the shaft at rest
    "angle": 0.7,  # rad from x towards y, where to
    "position": 0.23,  # m from the coupling
}
SIZE = ("stiffness",)
RANGE = {
    "stiffness": LogUniform(50.0, 3e3),
    "gap": Uniform(5e-5, 2e-4),
    "offset": Uniform(0.1, 0.8),
    "angle": ANY_PHASE,
    "position": Uniform(0.15, 0.44),
}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the push of the ring."""
    off = values["offset"] * values["gap"]
    centre = (off * math.cos(values["angle"]), off * math.sin(values["angle"]))
    constants = (values["stiffness"], values["gap"], *centre)
    return (Force(on=at(values["position"]), law=ring, constants=constants, from_rest=True),)


@law
def ring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = stiffness, gap, x and y of the ring's centre."""
    x, y = motion.x - p[2], motion.y - p[3]
    r = math.hypot(x, y)
    if r <= p[1]:
        return 0.0, 0.0
    k = p[0] * (1.0 - p[1] / r)
    return -k * x, -k * y
