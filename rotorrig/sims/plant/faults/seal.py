"""A liquid seal round the shaft, away from its bearings: it damps in axes that turn with the liquid.

The liquid in the gap is carried round at a share of the shaft's speed. Seen from there it does nothing but damp,
-D (z' - j share W z) of the shaft's motion z = x + j y: direct damping D, and a cross-coupled stiffness share W D that
grows with speed (Black, Effects of hydraulic forces in annular pressure seals on the vibrations of centrifugal pump
rotors, J. Mech. Eng. Sci. 11 (1969) 206, with half the speed; Muszynska, Whirl and whip, J. Sound Vib. 110 (1986) 443,
for other shares). Black's direct stiffness and mass are left out: they go with the pressure, and a kit's gap has hardly
any. `skew_stiffness` is at a bearing and pushes alone; this damps as well, and anywhere. Forward whirl gains from it
only at speeds above the critical one over the share, which no plan of the rig reaches. The seal is centred on the shaft
at rest.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "damping": 80.0,  # N s/m
    "share": 0.45,  # of the shaft's speed, that of the liquid: the less the more it swirls against entering
    "position": 0.19,  # m from the coupling
}
SIZE = ("damping",)
RANGE = {"damping": LogUniform(30.0, 200.0), "share": Uniform(0.3, 0.55), "position": Uniform(0.12, 0.44)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the force of the liquid on the shaft."""
    constants = (values["damping"], values["share"])
    return (Force(on=at(values["position"]), law=swirl, constants=constants, from_rest=True),)


@law
def swirl(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = damping, share of the speed that the liquid turns at."""
    carried = p[1] * turn.omega
    return -p[0] * (motion.vx + carried * motion.y), -p[0] * (motion.vy - carried * motion.x)
