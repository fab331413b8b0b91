"""A slender bracket that holds a probe and resonates: the probe tells the shaft's motion less the bracket's own.

The base under the bracket moves by a small share of what the shaft does, as the bearings' springs push it. The bracket
is a mass on a spring upon that base, along the direction the probe looks in: stiff, it moves as the base does, near its
own frequency many times more, beyond it not at all (Thomson, Theory of Vibration with Applications, 2nd ed. 1981, sec.
3.5, support motion; API 670, 5th ed. 2014, and Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics (2002),
want a bracket's frequency far above the machine's speed). A probe's reading is then off by a share that resonates over
speed. A kit's base is some 2 MN/m or more under bearings of 34 kN/m: a share of 2 % at most (an estimate). The rotor
feels nothing.
"""

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.faults.base import AnyProbe, LogUniform, Uniform, Values
from rotorrig.sims.plant.places import probe_of_number
from rotorrig.sims.plant.sensors import Chain

PARAMETERS: dict[str, float] = {
    "share": 0.01,  # of the shaft's motion at the probe, that of the base
    "frequency": 45.0,  # Hz, of the bracket alone
    "damping_ratio": 0.03,  # of a bolted joint
    "probe": 1.0,  # its number in the config, from 0
}
SIZE = ("share",)
RANGE = {
    "share": LogUniform(5e-4, 0.02),
    "frequency": Uniform(25.0, 75.0),  # the sweep ends at 60 Hz
    "damping_ratio": Uniform(0.02, 0.05),
    "probe": AnyProbe(),
}


def sensors(rig: RigConfig, chain: Chain, values: Values) -> Chain:
    """Return `chain` with one probe on such a bracket."""
    brackets = chain.brackets.copy()
    brackets[probe_of_number(rig, values["probe"])] = values["share"], values["frequency"], values["damping_ratio"]
    return chain._replace(brackets=brackets)
