"""A skewed disk: its axis stands at an angle to the shaft's, so that it tries to turn square to the axis of rotation.

The disk's normal is the shaft's slope plus a skew that turns with it. Euler's equations for the sum, It d'' - j Ip W d'
= moment, leave the moment (It - Ip) skew (W^2 - j a) on the shaft: Friswell et al., Dynamics of Rotating Machines
(2010), ch. 6. A thin disk has Ip above It and pulls itself upright.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import ANY_PHASE, LogUniform, Values
from rotorrig.sims.plant.force_laws import Force, heavy_spot, tilt
from rotorrig.sims.plant.places import disk_of_number, sense
from rotorrig.sims.plant.truth import Truth

PARAMETERS: dict[str, float] = {
    "skew": 2e-3,  # rad; a 75 mm disk then wobbles by 75 um at its rim
    "angle": 1.0,  # rad from shaft angle zero, in the sense of rotation: where the disk's normal leans
    "disk": 0.0,  # its number in the config, from 0
}
SIZE = ("skew",)
RANGE = {"skew": LogUniform(3e-4, 6e-3), "angle": ANY_PHASE}


def forces(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the moment of the disk on the shaft."""
    disk = disk_of_number(rig, values["disk"])
    factor = truth.disk_mass_factors[rig.disks.index(disk)]
    couple = (disk.transverse_inertia - disk.polar_inertia) * factor * values["skew"]
    return (Force(on=tilt(disk.position), law=heavy_spot, constants=(couple, sense(rig) * values["angle"])),)
