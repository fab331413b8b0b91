"""A misaligned coupling: an eccentric bore turns with the shaft (1X), an uneven stiffness meets a fixed offset (2X).

The bore's eccentricity bends the flexible element by the same amount in the rotating frame: a constant force there.
The motor's axis stands beside the rotor's by a fixed offset; a coupling that is stiffer along one of its diameters by
+variation and softer across it by -variation meets that offset twice per turn. In fixed axes its stiffness is
variation * [[cos 2b, sin 2b], [sin 2b, -cos 2b]], b the stiff diameter's angle (Timoshenko's two-stiffness shaft,
Vibration Problems in Engineering, 3rd ed. 1955, sec. 18), acting on offset less deflection. The mean stiffness is part
of no nameplate and is left out.
"""

import math
from collections.abc import Mapping

from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.plant.faults.base import PointForce, law

PARAMETERS: dict[str, float] = {
    "bore_force": 0.3,  # N, eccentricity of the bore times stiffness of the coupling: 60 um at 5 kN/m
    "bore_angle": 0.6,  # rad from shaft angle zero
    "offset": 1e-4,  # m, motor axis from rotor axis
    "offset_angle": 1.2,  # rad from +x, fixed in space
    "stiffness_variation": 3000.0,  # N/m; with the offset 0.3 N at twice per turn
    "stiff_diameter": 0.0,  # rad from shaft angle zero
}


def forces(rig: RigConfig, values: Mapping[str, float]) -> tuple[PointForce, ...]:
    """Return the coupling's force on the driven end of the shaft."""
    sense = 1.0 if rig.rotation == "x-to-y" else -1.0
    constants = (
        values["bore_force"],
        sense * values["bore_angle"],
        values["offset"] * math.cos(values["offset_angle"]),
        values["offset"] * math.sin(values["offset_angle"]),
        values["stiffness_variation"],
        sense * values["stiff_diameter"],
    )
    return (PointForce(position=0.0, law=force, constants=constants),)


@law
def force(angle: float, omega: float, x: float, y: float, vx: float, vy: float, p: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = bore force, bore angle, offset x, y, stiffness variation, stiff diameter."""
    bore_force, bore_angle = p[0], p[1]
    bend_x, bend_y = p[2] - x, p[3] - y
    variation, stiff = p[4], p[5]
    c, s = math.cos(2.0 * (angle + stiff)), math.sin(2.0 * (angle + stiff))
    fx = bore_force * math.cos(angle + bore_angle) + variation * (c * bend_x + s * bend_y)
    fy = bore_force * math.sin(angle + bore_angle) + variation * (s * bend_x - c * bend_y)
    return fx, fy
