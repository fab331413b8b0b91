"""A rotor as the TOML that ROSS 2.3 loads (`Rotor.load`): `ross_text(rotor)`."""

import json
from collections.abc import Iterator

from rotorrig.rig.config import COEFFICIENTS
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.rotor import BearingElement, DiskElement, RossRotor, ShaftElement

Values = Iterator[tuple[str, object]]


def ross_text(rotor: RossRotor, *, source: str) -> str:
    """Return the TOML that `Rotor.load` of ROSS 2.3 reads, its notes and `source` as comments.

    Raises ConfigError if two elements have one tag, which ROSS forbids.
    """
    _check_tags([*(e.tag for e in rotor.shaft), *(d.tag for d in rotor.disks), *(b.tag for b in rotor.bearings)])
    notes = [f"The rotor of {source}, for Rotor.load of ROSS {rotor.version}.", *rotor.notes]
    comments = "".join(f"# {sentence}\n" for sentence in notes)
    tables = [
        *(_table(f"ShaftElement_{e.tag}", _shaft_values(e)) for e in rotor.shaft),
        *(_table(f"DiskElement_{d.tag}", _disk_values(d)) for d in rotor.disks),
        *(_table(f"BearingElement_{b.tag}", _bearing_values(b)) for b in rotor.bearings),
    ]
    return "\n".join([comments, f'ross_version = "{rotor.version}"\n', "[parameters]\n", *tables])


def _check_tags(tags: list[str]) -> None:
    for tag in tags:
        if tags.count(tag) > 1:
            raise ConfigError(
                f"two parts are named '{tag}', want different names: ROSS tells its elements apart by them"
            )


def _shaft_values(element: ShaftElement) -> Values:
    yield from (("L", element.length), ("n", element.n), ("tag", element.tag))
    yield from zip(("odl", "odr", "idl", "idr"), (*element.outer, *element.inner), strict=True)
    yield from (("axial_force", 0.0), ("torque", 0.0), ("alpha", element.alpha), ("beta", element.beta))
    yield from ((key, True) for key in ("shear_effects", "rotary_inertia", "gyroscopic"))
    yield "shear_method_calc", "cowper"
    material = element.material
    yield from (("material.name", "shaft"), ("material.rho", material.density))
    yield from (("material.E", material.youngs_modulus), ("material.G_s", material.shear_modulus))
    yield "material.color", "#525252"


def _disk_values(disk: DiskElement) -> Values:
    yield from (("n", disk.n), ("tag", disk.tag))
    yield from (("m", disk.mass), ("Id", disk.transverse_inertia), ("Ip", disk.polar_inertia))
    yield from (("scale_factor", 1.0), ("color", "Firebrick"))


def _bearing_values(bearing: BearingElement) -> Values:
    yield from (("n", bearing.n), ("tag", bearing.tag))
    if bearing.frequency:
        yield "frequency", list(bearing.frequency)
    yield from ((key, list(bearing.coefficients[key])) for key in COEFFICIENTS)
    yield from (("scale_factor", 1), ("color", "#355d7a"))


def _table(name: str, values: Values) -> str:
    lines = [f"[{json.dumps(name, ensure_ascii=False)}]"]
    return "\n".join([*lines, *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in values)]) + "\n"
