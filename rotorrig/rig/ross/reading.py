"""A rotor that ROSS 2.3 has saved (`Rotor.save`, TOML or JSON): `read_ross(path)`.

The file has one table per element, "<class>_<tag>", in SI units. Read are uniform or tapered shaft elements, disks,
point masses, and whatever has a bearing's coefficients (seals and hydrodynamic bearings too: ROSS stores what it
computed for them). What cannot be represented here is refused by name; what is left out or changed is noted.
"""

import itertools
import json
import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple, TypeGuard

from rotorrig.rig.config import COEFFICIENTS
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.rotor import BearingElement, DiskElement, Material, RossRotor, ShaftElement

_DIRECT = ("kxx", "kyy", "cxx", "cyy")
SLEEVE = 1e-3  # of the shaft's stiffness: elements around it with less are there for their mass
_node = attrgetter("n")
_EFFECTS = {"shear_effects": "shear", "rotary_inertia": "rotary inertia", "gyroscopic": "gyroscopic moments"}


def read_ross(path: Path) -> RossRotor:
    """Read a rotor saved by ROSS as .toml or .json. Raises ConfigError naming the file, the element and what is wanted.

    Sleeves without stiffness, as ROSS's users put around an element for their mass, become disks at its ends.
    """
    content = _load(path)
    read = _Reading()
    for key, values in content.items():
        kind, _, tag = key.partition("_")
        if kind and tag and isinstance(values, dict):
            tag = str(values.get("tag", tag))  # in the key ROSS doubles a backslash with every element it saves
            read.add(_Table(where=f"{path}: {kind} '{tag}'", kind=kind, tag=tag, values=values))
    shaft = read.take_row(path)
    placed: list[DiskElement | BearingElement] = [*read.disks, *read.bearings]
    for part in placed:
        if part.n > len(shaft):
            raise ConfigError(f"{path}: '{part.tag}' is at node {part.n}, want it on the shaft, node 0 to {len(shaft)}")
    return RossRotor(
        shaft=shaft,
        disks=tuple(read.disks),
        bearings=tuple(read.bearings),
        version=str(content["ross_version"]),
        notes=tuple(f"{note}: {', '.join(map(repr, tags))}." for note, tags in read.noted.items()),
    )


class _Table(NamedTuple):
    """One element of the file, and how to complain about it."""

    where: str
    kind: str
    tag: str
    values: dict[str, Any]

    def refusal(self, reason: str) -> ConfigError:
        return ConfigError(f"{self.where}: {reason}")

    def number(self, key: str, default: float | None = None) -> float:
        value = self.values.get(key, default)
        if not _is_number(value):
            raise self.refusal(f"{key}: " + ("is missing" if value is None else f"got {value!r}") + ", want a number")
        return float(value)

    def node(self) -> int:
        value = self.values.get("n")
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            raise self.refusal(f"n: got {value!r}, want the number of a node")
        return value

    def numbers(self, key: str) -> tuple[float, ...]:
        value = self.values.get(key, 0.0)
        listed = value if isinstance(value, list) else [value]
        if not listed or not all(map(_is_number, listed)):
            raise self.refusal(f"{key}: got {value!r}, want a list of numbers")
        return tuple(map(float, listed))


@dataclass(slots=True)
class _Reading:
    """Elements read so far, with notes on what differs here."""

    shaft: list[ShaftElement] = field(default_factory=list)
    disks: list[DiskElement] = field(default_factory=list)
    bearings: list[BearingElement] = field(default_factory=list)
    noted: dict[str, list[str]] = field(default_factory=dict)  # note -> tags of its elements

    def add(self, table: _Table) -> None:
        if table.kind == "ShaftElement":
            self.shaft.append(element := _shaft_element(table))
            if element.tapered:
                self.note("Tapered in ROSS, in uniform steps here, so that figures differ slightly", table)
            if table.values.get("shear_method_calc", "cowper") != "cowper":
                self.note("The shear factor is Hutchinson's in ROSS, Cowper's here", table)
        elif table.kind == "DiskElement":
            self.disks.append(_disk_element(table))
        elif table.kind == "PointMass":
            self.disks.append(_point_mass(table))
        elif "kxx" in table.values and "cxx" in table.values:
            self._bearing(table)
        else:
            raise table.refusal("has no counterpart here, want shaft elements, disks, point masses, bearings, seals")

    def take_row(self, path: Path) -> tuple[ShaftElement, ...]:
        """Return the elements from left to right; what lies around them for its mass becomes disks at the nodes."""
        row: list[ShaftElement] = []
        sleeves: list[ShaftElement] = []
        by_node = {n: list(alike) for n, alike in itertools.groupby(sorted(self.shaft, key=_node), key=_node)}
        for n in range(max(by_node, default=0) + 1):
            if n not in by_node:
                raise ConfigError(f"{path}: no shaft element starts at node {n}, want one shaft without a gap")
            core, *around = sorted(by_node[n], key=lambda e: e.bending_stiffness, reverse=True)
            if around and around[0].bending_stiffness > SLEEVE * core.bending_stiffness:
                raise ConfigError(
                    f"{path}: '{core.tag}' and '{around[0].tag}' both start at node {n} and are both stiff, "
                    "want one tube between two nodes"
                )
            row.append(core)
            sleeves += around
        self.disks += _sleeve_disks(sleeves)
        for sleeve in sleeves:
            self.note("Without stiffness of its own, so disks at the nodes here", sleeve)
        return tuple(row)

    def note(self, note: str, part: _Table | ShaftElement) -> None:
        self.noted.setdefault(note, []).append(part.tag)

    def _bearing(self, table: _Table) -> None:
        bearing = _bearing_element(table)
        if not any(any(values) for values in bearing.coefficients.values()):
            self.note("Left out, as without any lateral coefficient", table)
            return
        self.bearings.append(bearing)
        if any(len(set(values)) > 1 for values in bearing.coefficients.values()):
            self.note("Coefficients over speed are joined by straight lines here, by a curve in ROSS", table)
        if any(any(table.numbers(key)) for key in ("kzz", "czz", "mzz")):
            self.note("Without its axial coefficients here, as the model is of lateral motion", table)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _load(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        content = json.loads(text) if path.suffix.lower() == ".json" else tomllib.loads(text)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}), want a rotor saved by ROSS") from error
    except (ValueError, RecursionError) as error:  # JSON's, TOML's and UTF-8's; nested too deep
        raise ConfigError(f"{path}: is no valid {path.suffix.lower().lstrip('.') or 'TOML'}: {error}") from error
    if not isinstance(content, dict) or "ross_version" not in content or "parameters" not in content:
        raise ConfigError(f"{path}: has no ross_version and parameters, want a rotor saved by ROSS 2 (Rotor.save)")
    return content


def _shaft_element(table: _Table) -> ShaftElement:
    for key, effect in _EFFECTS.items():
        if not table.values.get(key, True):
            raise table.refusal(f"{key} is false, want it true: the shaft here always has {effect}")
    for key in ("axial_force", "torque"):
        if table.number(key, 0.0):
            raise table.refusal(f"{key} is {table.number(key):g}, want 0: the shaft here carries none")
    material = table.values.get("material")
    if not isinstance(material, dict):
        raise table.refusal("material: is missing, want rho, E and G_s")
    stuff = table._replace(where=f"{table.where} material", values=material)
    if not (shear_modulus := stuff.number("G_s")) > 0:
        raise stuff.refusal(f"G_s is {shear_modulus:g} Pa, want it above zero")
    odl, idl = table.number("odl"), table.number("idl")
    return ShaftElement(
        tag=table.tag,
        n=table.node(),
        length=table.number("L"),
        outer=(odl, table.number("odr", odl)),
        inner=(idl, table.number("idr", idl)),
        material=Material(stuff.number("rho"), stuff.number("E"), shear_modulus),
        alpha=table.number("alpha", 0.0),
        beta=table.number("beta", 0.0),
    )


def _disk_element(table: _Table) -> DiskElement:
    return DiskElement(
        tag=table.tag,
        n=table.node(),
        mass=table.number("m"),
        transverse_inertia=table.number("Id"),
        polar_inertia=table.number("Ip"),
    )


def _point_mass(table: _Table) -> DiskElement:
    mass = table.number("mx")
    if table.number("my") != mass:
        raise table.refusal(f"mx is {mass:g} and my {table.number('my'):g} kg, want one mass: a disk here has no two")
    return DiskElement(tag=table.tag, n=table.node(), mass=mass, transverse_inertia=0.0, polar_inertia=0.0)


def _bearing_element(table: _Table) -> BearingElement:
    if table.values.get("n_link") is not None:
        raise table.refusal(f"stands on node {table.values['n_link']}, want it on the ground: no supports here")
    for key in ("mxx", "mxy", "myx", "myy"):
        if any(mass := table.numbers(key)):
            raise table.refusal(f"{key} is {mass[0]:g} kg, want 0: a bearing here has stiffness and damping only")
    frequency = table.numbers("frequency") if table.values.get("frequency") is not None else ()
    coefficients = {key: table.numbers(key) for key in COEFFICIENTS}
    for key, values in coefficients.items():
        if len(values) != (want := max(1, len(frequency))):
            raise table.refusal(f"{key} has {len(values)} values, want {want}, one for each frequency")
        if key in _DIRECT and min(values) < 0:
            raise table.refusal(f"{key} is {min(values):g}, want it at or above zero")
    return BearingElement(
        tag=table.tag, n=table.node(), kind=table.kind, frequency=frequency, coefficients=coefficients
    )


def _sleeve_disks(sleeves: list[ShaftElement]) -> Iterator[DiskElement]:
    """Yield the disks of half of every sleeve's mass and rotary inertia at either end, one for each node."""
    halves = sorted(((end, sleeve) for sleeve in sleeves for end in (sleeve.n, sleeve.n + 1)), key=lambda half: half[0])
    for n, here in itertools.groupby(halves, key=lambda half: half[0]):
        elements = [sleeve for _, sleeve in here]
        tilt = sum(e.material.density * e.second_moment * e.length for e in elements) / 2
        mass = sum(e.material.density * e.area * e.length for e in elements) / 2
        yield DiskElement(tag=f"sleeves at node {n}", n=n, mass=mass, transverse_inertia=tilt, polar_inertia=2 * tilt)
