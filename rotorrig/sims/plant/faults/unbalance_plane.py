"""A mass where no disk is: a set screw, a collar or a coupling bolt too many, somewhere along the shaft.

A mass m at radius r is pulled outwards by m r W^2 and left behind by m r a (ISO 21940-2: dynamic unbalance takes two
planes to describe), and has to be carried along by every whirl: it adds m to the shaft there, and its weight.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Uniform, Values
from rotorrig.sims.plant.force_laws import Force, at, heavy_spot
from rotorrig.sims.plant.places import sense
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "amount": 5e-6,  # kg m: a 0.5 g set screw at 10 mm
    "angle": 2.0,  # rad from shaft angle zero, in the sense of rotation
    "position": 0.38,  # m from the coupling
    "radius": 0.01,  # m, at which the mass sits
}
SIZE = ("amount",)
RANGE = {"amount": LogUniform(2e-6, 1e-5), "angle": ANY_PHASE, "position": Uniform(0.34, 0.46)}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the pull of the mass on the shaft."""
    constants = (values["amount"], sense(rig) * values["angle"])
    return (Force(on=at(values["position"]), law=heavy_spot, constants=constants),)


def structure(rig: RigConfig, truth: Truth, rotor: Rotor, values: Values) -> Rotor:
    """Return `rotor` with the mass on it."""
    mass = values["amount"] / values["radius"]
    M, weight = rotor.M.copy(), rotor.weight.copy()
    here = rotor.station(values["position"])
    for plane in (here, here + rotor.n):
        M[plane, plane] += mass
    weight[here] += mass
    return replace(rotor, M=M, weight=weight)
