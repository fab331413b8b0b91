"""What a config states and may have wrong, in the groups whose members the data hardly tell apart.

Modulus and diameter bend the shaft alike. A bearing that gives way, one that resists tilt, and both of a pair that
stands close together hold the shaft's end alike. Positions are judged together: the data see distances between parts.
The probes of one plane sit in one bracket, and move together.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.extended_model import KEYPHASOR, ExtendedParameters
from rotorrig.rig.config import Probe, RigConfig

CLOSE = 5.0  # shaft diameters: bearings no further apart hold the shaft together
SAME_PLANE = 1e-3  # m
STIFFEST_HUB = 0.89  # of the shaft's flexibility, that a hub may take away: beyond, no diameter stands for it


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One statement of a config, and the nuisances that say how far it is off."""

    kind: str  # "bearing_position"
    where: str  # "spring"; empty where there is one only
    title: str  # "position of bearing spring"
    nuisances: tuple[str, ...]  # which are off by the same amount
    unit: str = ""  # SI, of the deviation; "" for one relative to what is stated
    nameplate: float = float("nan")  # as stated, SI; NaN: no single number is
    nameplate_unit: str = ""
    one_sided: bool = False  # from zero up
    parameter: str = "off"  # name of the deviation, as an effect that says the same has it
    words: Callable[[str], str]  # the sentence, of "1.2 ± 0.1 mm" and the sign "+" or "-" before it

    def deviation(self, value: float) -> float:
        """Return the deviation that a value of the nuisances stands for: of a hub, the diameter it is as stiff as."""
        return float((1 - min(value, STIFFEST_HUB)) ** -0.25 - 1) if self.kind == "hub" else value

    def slope(self, value: float) -> float:
        """Return d deviation / d value."""
        return float((1 - min(value, STIFFEST_HUB)) ** -1.25 / 4) if self.kind == "hub" else 1.0


def nameplate_groups(names: ExtendedParameters, rig: RigConfig) -> dict[str, tuple[Member, ...]]:
    """Return the members of every group of which `names` has nuisances."""
    every = {
        "shaft stiffness": [*_shaft(rig)],
        "disk mass": [*_disk_mass(rig)],
        **{f"support {' + '.join(group)}": [*_support(rig, group)] for group in _supports(rig)},
        "positions": [*_positions(rig)],
        "hubs": [*_hubs(rig)],
        "probe gains": [*_gains(rig)],
        "probe angles": [*_angles(rig)],
        "keyphasor": [*_keyphasor()],
    }
    known = {names.names[i] for i in names.priors}
    groups = {group: tuple(m for m in members if known.issuperset(m.nuisances)) for group, members in every.items()}
    return {group: members for group, members in groups.items() if members}


def _shaft(rig: RigConfig) -> Iterator[Member]:
    yield Member(
        kind="youngs_modulus",
        where="",
        title="Young's modulus",
        nuisances=("E",),
        nameplate=rig.shaft.youngs_modulus,
        nameplate_unit="Pa",
        words=_comparing("Young's modulus of the shaft is", "higher", "lower"),
    )
    yield Member(
        kind="diameter",
        where="",
        title="diameter of the shaft",
        nuisances=("diameter",),
        nameplate=rig.shaft.diameter,
        nameplate_unit="m",
        words=_comparing("the shaft is", "thicker", "thinner"),
    )


def _disk_mass(rig: RigConfig) -> Iterator[Member]:
    one = len(rig.disks) == 1
    yield Member(
        kind="disk_mass",
        where="",
        title="mass of the disk" if one else "mass of the disks",
        nuisances=("disk mass",),
        nameplate=rig.disks[0].mass if one else float("nan"),
        nameplate_unit="kg",
        words=_comparing("the disk is" if one else "all disks are", "heavier", "lighter"),
    )


def _supports(rig: RigConfig) -> list[list[str]]:
    """Return the names of bearings that stand close together, from the coupling on."""
    supports: list[list[str]] = []
    last = -np.inf
    for bearing in sorted(rig.bearings, key=lambda b: b.position):
        if bearing.position - last > CLOSE * rig.shaft.diameter:
            supports.append([])
        supports[-1].append(bearing.name)
        last = bearing.position
    return supports


def _support(rig: RigConfig, group: list[str]) -> Iterator[Member]:
    """Yield stiffness, where it is stated and not sought, and tilt stiffness of bearings close together."""
    for name in group:
        bearing = rig.bearing(name)
        for axis, k in zip("xy", (bearing.kxx, bearing.kyy), strict=True):
            yield Member(
                kind="bearing_stiffness",
                where=f"{name} {axis}",
                title=f"stiffness of bearing {name} along {axis}",
                nuisances=(f"bearing {name} {axis}",),
                nameplate=k if isinstance(k, float) else float("nan"),
                nameplate_unit="N/m",
                words=_comparing(f"bearing {name} is", f"stiffer along {axis}", f"softer along {axis}"),
            )
        yield Member(
            kind="tilt",
            where=name,
            title=f"tilt stiffness of bearing {name}",
            nuisances=(f"tilt {name}",),
            unit="N m/rad",
            nameplate=bearing.tilt_stiffness or 0.0,
            nameplate_unit="N m/rad",
            one_sided=True,
            words=_comparing(f"bearing {name} resists tilt by", "more", "less"),
        )


def _positions(rig: RigConfig) -> Iterator[Member]:
    places = [("disk", d.name, [d.name], d.position) for d in rig.disks]
    places += [("bearing", b.name, [b.name], b.position) for b in rig.bearings]
    places += [("probe", plane[0].name, [p.name for p in plane], plane[0].position) for plane in _planes(rig)]
    for kind, name, parts, position in places:
        what = f"{kind}s {' and '.join(parts)}" if len(parts) > 1 else _call(kind, name)
        yield Member(
            kind=f"{kind}_position",
            where=name,
            title=f"position of {what}",
            nuisances=tuple(f"position {kind} {part}" for part in parts),
            unit="m",
            nameplate=position,
            nameplate_unit="m",
            words=_comparing(
                f"{what} {'sit' if len(parts) > 1 else 'sits'}", "further from the coupling", "nearer to the coupling"
            ),
        )


def _planes(rig: RigConfig) -> list[list[Probe]]:
    """Return the probes of every plane, in the order of the config."""
    planes: list[list[Probe]] = []
    for probe in rig.probes:
        mine = next((plane for plane in planes if abs(plane[0].position - probe.position) < SAME_PLANE), None)
        if mine is None:
            planes.append([probe])
        else:
            mine.append(probe)
    return planes


def _hubs(rig: RigConfig) -> Iterator[Member]:
    for disk in rig.disks:
        yield Member(
            kind="hub",
            where=disk.name,
            title=f"shaft under the hub of {_call('disk', disk.name)}",
            nuisances=(f"hub {disk.name}",),
            one_sided=True,
            words=_comparing(
                f"under the hub of {_call('disk', disk.name)} the shaft is as stiff as one", "thicker", "thinner"
            ),
        )


def _gains(rig: RigConfig) -> Iterator[Member]:
    for probe in rig.probes:
        yield Member(
            kind="probe_gain",
            where=f"probe {probe.name}",
            title=f"sensitivity of probe {probe.name}",
            nuisances=(f"gain {probe.name}",),
            nameplate=probe.sensitivity,
            nameplate_unit="V/m",
            parameter="error",
            words=_comparing(f"probe {probe.name} is", "more sensitive", "less sensitive"),
        )


def _angles(rig: RigConfig) -> Iterator[Member]:
    for probe in rig.probes:
        yield Member(
            kind="probe_angle",
            where=f"probe {probe.name}",
            title=f"angle of probe {probe.name}",
            nuisances=(f"angle {probe.name}",),
            unit="rad",
            nameplate=probe.angle,
            nameplate_unit="rad",
            parameter="turn",
            words=_comparing(
                f"probe {probe.name} is turned by", "further from x towards y", "further from y towards x"
            ),
        )


def _keyphasor() -> Iterator[Member]:
    yield Member(
        kind="keyphasor_angle",
        where="",
        title="angle of the keyphasor mark",
        nuisances=(KEYPHASOR,),
        unit="rad",
        nameplate=0.0,
        nameplate_unit="rad",
        words=_comparing("the keyphasor mark sits", "further in the sense of rotation", "further against rotation"),
    )


def _call(kind: str, name: str) -> str:
    """Return what a part is called: "disk 2", where its name is that of its kind "the disk"."""
    return f"the {kind}" if name == kind else name if name.startswith(f"{kind} ") else f"{kind} {name}"


def _comparing(begin: str, more: str, less: str) -> Callable[[str], str]:
    """Return what makes a sentence of "+1.2 ± 0.1 mm"."""
    return lambda size: f"{begin} {size[1:]} {less if size[0] == '-' else more} than the config says"
