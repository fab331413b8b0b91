"""A disk whose moments of inertia are not what its nameplate says, though its mass is: a rim, a bore, balance holes.

The gyroscopic moment is the rate of change of the spin's angular momentum Ip W along the tilting axis, the inertial one
It times the tilt's acceleration.
"""

from dataclasses import replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import LogUniform, Values
from rotorrig.sims.plant.places import disk_of_number
from rotorrig.sims.plant.shaft import Rotor
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "polar": 0.2,  # of its polar moment, more
    "transverse": 0.2,  # of its transverse moment, more
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("polar", "transverse")
RANGE = {"polar": LogUniform(0.12, 0.3, either_sign=True), "transverse": LogUniform(0.12, 0.3, either_sign=True)}


def structure(rig: RigConfig, truth: Truth, rotor: Rotor, values: Values) -> Rotor:
    """Return `rotor` with other inertia of one disk against tilting."""
    disk = disk_of_number(rig, values["disk"])
    factor = truth.disk_mass_factors[rig.disks.index(disk)]
    M, G = rotor.M.copy(), rotor.G.copy()
    tilt = rotor.slope(disk.position)
    for plane in (tilt, tilt + rotor.n):
        M[plane, plane] += values["transverse"] * factor * disk.transverse_inertia
    G[tilt, tilt] += values["polar"] * factor * disk.polar_inertia
    return replace(rotor, M=M, G=G)
