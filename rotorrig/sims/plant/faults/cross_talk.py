"""The two probes of a plane hear each other: their tips are too near, and their fields overlap.

Each coil's field reaches what the other looks at, the further the less of it the shaft keeps in: the share grows by e
for every 2 mm that the two gaps widen together (after the field of a coil over a conductor, whose wave numbers lie
about 1.5 over its mean radius: Dodd and Deeds, Analytical solutions to eddy-current probe-coil problems, J. Appl. Phys.
39 (1968) 2829; the coil of an 8 mm tip has 3 mm). So the cross-talk is not quite in proportion to the motion. Makers
ask for some tens of millimetres between two tips, which a shaft of 10 mm cannot offer.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number, same_plane
from rotorrig.sims.plant.sensors import Chain

PARAMETERS: dict[str, float] = {
    "share": 0.02,  # of the other probe's signal, at the gap voltage of both
    "probe": 0.0,  # the number of a probe in the plane, from 0
}
SIZE = ("share",)
RANGE = {"share": LogUniform(0.07, 0.2), "probe": AnyProbe()}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with the probes of one plane mixed."""
    plane = same_plane(rig, probe_of_number(rig, values["probe"]))
    mixing = chain.mixing.copy()
    for p in plane:
        for other in plane:
            mixing[p, other] += values["share"] * (p != other)
    return chain._replace(mixing=mixing)
