"""The two probes of a plane hear each other: their tips are too near, and their fields overlap.

Each coil's field reaches what the other looks at; both channels then show a share of what the other sees. Makers ask
for some tens of millimetres between two tips, which a shaft of 10 mm cannot offer.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.chain import Chain
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Values
from rotorrig.sims.plant.places import probe_of_number, same_plane

PARAMETERS: dict[str, float] = {
    "share": 0.02,  # of the other probe's signal
    "probe": 0.0,  # the number of a probe in the plane, from 0
}
SIZE = ("share",)
RANGE = {"share": LogUniform(0.004, 0.06), "probe": AnyProbe()}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with the probes of one plane mixed."""
    plane = same_plane(rig, probe_of_number(rig, values["probe"]))
    mixing = chain.mixing.copy()
    for p in plane:
        for other in plane:
            mixing[p, other] += values["share"] * (p != other)
    return chain._replace(mixing=mixing)
