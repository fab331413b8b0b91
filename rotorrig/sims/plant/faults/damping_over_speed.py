"""A squeeze film damper round a bearing that starves at low speed: its damping grows as the shaft's oil pump fills it.

Fed too little, the film cavitates and draws in air; what part of it is whole resists as a short film does, in
proportion to the velocity (Gunter, Barrett and Allaire, Design of nonlinear squeeze-film dampers for aircraft engines,
J. Lubr. Technol. 99 (1977) 57: a whole film damps twice as much as one of which half has cavitated). A centrifugal pump
on the shaft feeds it: pressure goes as W^2, and the part that it fills is taken as s^2 / (1 + s^2), s = W / W_r, half
of it at the reference speed (an estimate). The motion is small against the film. A healthy bearing's damping goes with
speed too, linearly and by a tenth (`deviations.DAMPING_GROWTH`); this one begins from nothing, levels off, and is many
times the bearing's own: less would hide in it, as a resonance shows little but the damping at its own speed.
"""

from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.places import sought_bearings
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "damping": 100.0,  # N s/m, of the whole film
    "reference": 250.0,  # rad/s, where half of it is full
}
SIZE = ("damping",)
RANGE = {"damping": LogUniform(40.0, 300.0), "reference": Uniform(150.0, 350.0)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the drag of the film at each bearing sought."""
    constants = (values["damping"], values["reference"])
    return tuple(Force(on=at(b.position), law=film, constants=constants) for b in sought_bearings(rig))


@law
def film(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = damping of the whole film, reference speed."""
    square = (turn.omega / p[1]) ** 2
    c = p[0] * square / (1.0 + square)
    return -c * motion.vx, -c * motion.vy
