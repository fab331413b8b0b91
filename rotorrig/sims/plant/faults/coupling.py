"""A misaligned coupling: a universal joint with elastic arms, between a motor and a shaft whose axes do not meet.

The joint's cross has one arm in the shaft's yoke and one, always square to it, in the motor's, so that the distance of
the two axes is taken up by an arm sliding along itself: whatever it is, it is met by the spring of one arm and, a
quarter of a turn later, by that of the other (Hooke's joint: Seherr-Thoss, Schmelz and Aucktor, Universal Joints and
Driveshafts (2006), ch. 1; its forces on a rotor: Xu and Marangoni, Vibration analysis of a motor-flexible
coupling-rotor system subject to misalignment and unbalance, J. Sound Vib. 176 (1994) 663). Arms of unlike stiffness
make that a force twice per turn on top of a constant one. An eccentric bore adds a distance that turns with the shaft.
The axes also meet at an angle, offset over the joint's length, by which the motor's arm runs ahead of its place and
behind twice a turn; and the arms' bushes stiffen as they are pressed (rubber in compression: Lindley, J. Strain Anal. 1
(1966) 190; the strain at which is an estimate), which brings further even orders.
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
MEAN = 1.2  # stiffness of the two arms, half their sum, over half their difference: the weak one is a loose fit
LENGTH = 0.03  # m from yoke to yoke: an estimate
BUSH = 2e-3  # m, rubber an arm presses on: at a tenth of it a bush is stiffer by 2 %


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
    return (Force(on=at(0.0), law=cross, constants=constants),)


@law
def cross(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = bore force, bore angle, offset x, y, stiffness variation, stiff diameter."""
    bore_force, bore = p[0], turn.angle + p[1]
    away_x, away_y, stiff = p[2] - motion.x, p[3] - motion.y, turn.angle + p[5]
    a_x, a_y = math.cos(stiff), math.sin(stiff)
    # the motor's arm is square to its axis and to the other arm: it leaves the shaft's plane by the lean it meets,
    # and of its spring's pull only what lies in that plane acts sideways
    lean = (p[3] * a_x - p[2] * a_y) / LENGTH
    in_plane = 1.0 / (1.0 + lean * lean)
    along = away_x * a_x + away_y * a_y
    across = away_y * a_x - away_x * a_y
    pull = p[4] * (MEAN + 1.0) * along * (1.0 + 2.0 * (along / BUSH) ** 2)
    push = p[4] * (MEAN - 1.0) * across * (1.0 + 2.0 * (across / BUSH) ** 2) * in_plane
    fx = bore_force * math.cos(bore) + pull * a_x - push * a_y
    fy = bore_force * math.sin(bore) + pull * a_y + push * a_x
    return fx, fy
