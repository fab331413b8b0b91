"""What of the nameplate is wrong in a rig, by how much, and so may be named: the dimensions, the probes, the shaft.

Every rig departs from its nameplate by a little. Nobody asks for that to be named, but who names it is right if the
95 % interval of the deviation that is told holds the true one; a wrong member of its group is wrong.
"""

from collections.abc import Iterator

from benchmarks.parts.blind.names import Answer
from benchmarks.parts.blind.rigs.deviants import Deviation
from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant import Truth
from rotorrig.sims.plant.places import held_bearings, true_bearing


def answer_dimension(deviation: Deviation) -> Answer:
    """Return the right answer for a dimension that the nameplate has wrongly: that one, off by that much."""
    label = f"{deviation.kind}, {deviation.part}" if deviation.part else deviation.kind
    return _expect(label, deviation.value, asked=deviation.asked)


def answer_rest(rig: RigConfig, truth: Truth) -> Iterator[Answer]:
    """Yield the right answers for what else is stated: shaft, disk, bearings that are not sought, probes, keyphasor.

    Of several disks only their mean mass could be named, which is nobody's.
    """
    yield _expect("youngs_modulus", truth.modulus_factor - 1.0)
    if len(rig.disks) == 1:
        yield _expect("disk_mass", truth.disk_mass_factors[0] - 1.0)
    for bearing in held_bearings(rig):
        for axis, name in (("x", "kxx"), ("y", "kyy")):
            true, stated = getattr(true_bearing(truth, bearing), name), bearing.constant(name)
            yield _expect(f"bearing_stiffness, {bearing.name} {axis}", true / stated - 1.0)
    for probe, gain, turn in zip(rig.probes, truth.probe_gain_factors, truth.probe_angle_errors, strict=True):
        yield _expect(f"probe_gain, probe {probe.name}", gain - 1.0, parameter="error")
        yield _expect(f"probe_angle, probe {probe.name}", turn, parameter="turn")
    yield _expect("keyphasor_angle", truth.keyphasor_offset)


def _expect(label: str, value: float, *, parameter: str = "off", asked: bool = False) -> Answer:
    return Answer(labels=(label,), exact=label, theta={parameter: value}, same=(parameter,), asked=asked, interval=True)
