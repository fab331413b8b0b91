"""What a discovery ought to find of every fault of the simulated rig: a force or a reading, where, and by which law.

Faults and laws were written apart; this table is the only place that knows both.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant import FaultSpec
from rotorrig.sims.plant.faults import load_fault
from rotorrig.sims.plant.places import disk_of_number, held_bearings, sought_bearings

Values = Mapping[str, float]
Places = Callable[[RigConfig, Values], tuple[float, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """The right answer: what kind it is of, its places [m], none if it is spread over the shaft, and its laws."""

    kind: Literal["force", "reading"]
    places: tuple[float, ...] = ()
    laws: tuple[str, ...] = ()  # any of these says rightly how it goes; none: no law of the library does


def _at(name: str) -> Places:
    return lambda rig, values: (values[name],)


def _sought(rig: RigConfig, values: Values) -> tuple[float, ...]:
    return tuple(b.position for b in sought_bearings(rig))


def _held(rig: RigConfig, values: Values) -> tuple[float, ...]:
    return tuple(b.position for b in held_bearings(rig))


def _disk(rig: RigConfig, values: Values) -> tuple[float, ...]:
    return (disk_of_number(rig, values["disk"]).position,)


def _coupled_end(rig: RigConfig, values: Values) -> tuple[float, ...]:
    return (0.0,)


def _spread(rig: RigConfig, values: Values) -> tuple[float, ...]:
    return ()


FORCES: Mapping[str, tuple[Places, tuple[str, ...]]] = {
    "bow": (_spread, ("force", "moment")),
    "clearance": (_sought, ("cubic stiffness",)),
    "couple": (_disk, ("moment by speed squared",)),
    "coupling": (_coupled_end, ("force", "moment")),
    "crack": (_at("position"), ()),
    "cross_stiffness": (_sought, ("skew stiffness",)),
    "cubic_spring": (_sought, ("cubic stiffness",)),
    "damping_over_speed": (_sought, ()),
    "disk_inertia": (_disk, ("tilt stiffness",)),
    "friction": (_sought, ("dry friction",)),
    "hysteresis": (_spread, ("damping",)),
    "internal_damping": (_spread, ("cross-coupled stiffness over speed",)),
    "loose_disk": (_disk, ()),
    "loose_pedestal": (_sought, ()),
    "magnetic_pull": (_disk, ("skew stiffness", "stiffness")),
    "pedestal": (_sought, ("resonance",)),
    "rub": (_at("position"), ("cubic stiffness",)),
    "seal": (_at("position"), ("cross-coupled stiffness over speed", "damping")),
    "shaft_asymmetry": (_spread, ()),
    "skew_stiffness": (_sought, ("cross-coupled stiffness",)),
    "slipping_coupling": (_coupled_end, ()),
    "snubber": (_at("position"), ("cubic stiffness",)),
    "soft_left_bearing": (_held, ("stiffness", "damping", "tilt stiffness")),
    "stiffness_over_speed": (_sought, ("stiffness over speed",)),
    "unbalance_drift": (_disk, ()),
    "unbalance_plane": (_at("position"), ("speed squared",)),
    "unbalance_step": (_disk, ()),
}
READINGS = (
    "cross_talk",
    "delay",
    "line_hum",
    "probe_angle",
    "probe_bracket",
    "probe_curvature",
    "probe_gain",
    "runout",
)


def expected(rig: RigConfig, fault: FaultSpec) -> Expected | None:
    """Return the right answer for a fault; None where neither a force nor a reading at shaft orders stands for it.

    So it is with drag, which turns the rotor and does not bend it, and a pull at twice the line frequency.
    """
    if fault.name in READINGS:
        return Expected(kind="reading")
    if fault.name not in FORCES:
        return None
    places, laws = FORCES[fault.name]
    return Expected(kind="force", places=places(rig, load_fault(fault.name).PARAMETERS | fault.parameters), laws=laws)
