"""Where along the shaft a cause acts, for a drawing."""

import re

from rotorrig.identify.verdict import Cause
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import Effect, catalogue

AT = re.compile(r"\bat ([\d.]+) mm")  # an effect that is looked for all along the shaft has its place in its name
PARTS = ("place", "plane", "disk", "probe", "bearings", "probes", "turned")  # of the rig, as effects call theirs


def cause_places(cause: Cause, rig: RigConfig) -> tuple[float, ...]:
    """Return the places [m from the coupling] at which a cause acts; none if it has no place, or all of the shaft."""
    if "place" in cause.parameters:  # it is one of its unknowns, as a crack's
        return (cause.parameters["place"].value,)
    if cause.effect == "coupling":
        return (0.0,)
    if found := AT.search(cause.where):
        return (float(found[1]) * 1e-3,)
    named = [(p.name, p.position) for p in rig.disks] + [(p.name, p.position) for p in rig.planes]
    named += [(p.name, p.position) for p in rig.bearings] + [(p.name, p.position) for p in rig.probes]
    parts = dict(named)
    effect = next((e for e in catalogue(rig) if e.label == cause.label), None)
    names = _names(effect) if effect else [name for name in parts if re.search(rf"\b{re.escape(name)}\b", cause.where)]
    return tuple(sorted({parts[name] for name in names if name in parts}))


def _names(effect: Effect) -> list[str]:
    """Return the parts of the rig that an effect names."""
    values = [
        getattr(effect, "turned" if part == "plane" and hasattr(effect, "turned") else part, ()) for part in PARTS
    ]
    return [name for value in values for name in ((value,) if isinstance(value, str) else value)]
