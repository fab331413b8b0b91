"""A misaligned coupling: an eccentric bore turns with the shaft (1X), an uneven stiffness meets a fixed offset (2X).

The bore's eccentricity bends the flexible element by the same amount in the rotating frame: a constant force there.
The motor's axis stands beside the rotor's by a fixed offset; a coupling that is stiffer along one of its diameters by
+variation and softer across it by -variation meets that offset twice per turn. In fixed axes its stiffness is
variation * [[cos 2b, sin 2b], [sin 2b, -cos 2b]], b the stiff diameter's angle (Timoshenko's two-stiffness shaft,
Vibration Problems in Engineering, 3rd ed. 1955, sec. 18), acting on offset less deflection. The mean stiffness is part
of no nameplate and is left out.
"""

import math

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "bore_force": 0.3,  # N, eccentricity of the bore times stiffness of the coupling: 60 um at 5 kN/m
    "bore_angle": 0.6,  # rad from shaft angle zero
    "offset": 1e-4,  # m, motor axis from rotor axis
    "offset_angle": 1.2,  # rad from +x, fixed in space
    "stiffness_variation": 3000.0,  # N/m; with the offset 0.3 N at twice per turn
    "stiff_diameter": 0.0,  # rad from shaft angle zero
}
SIZE = ("bore_force", "stiffness_variation")
RANGE = {
    "bore_force": LogUniform(0.01, 0.6),
    "bore_angle": ANY_PHASE,
    "offset": Uniform(5e-5, 2e-4),
    "offset_angle": ANY_PHASE,
    "stiffness_variation": LogUniform(100.0, 5000.0),
    "stiff_diameter": ANY_PHASE,
}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the coupling's force on the driven end of the shaft."""
    constants = (
        values["bore_force"],
        sense(rig) * values["bore_angle"],
        values["offset"] * math.cos(values["offset_angle"]),
        values["offset"] * math.sin(values["offset_angle"]),
        values["stiffness_variation"],
        sense(rig) * values["stiff_diameter"],
    )
    return (Force(on=at(0.0), law=force, constants=constants),)


@law
def force(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = bore force, bore angle, offset x, y, stiffness variation, stiff diameter."""
    bore_force, bore = p[0], turn.angle + p[1]
    bend_x, bend_y = p[2] - motion.x, p[3] - motion.y
    variation, stiff = p[4], turn.angle + p[5]
    c, s = math.cos(2.0 * stiff), math.sin(2.0 * stiff)
    fx = bore_force * math.cos(bore) + variation * (c * bend_x + s * bend_y)
    fy = bore_force * math.sin(bore) + variation * (s * bend_x - c * bend_y)
    return fx, fy
