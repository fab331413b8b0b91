"""From a rotor of ROSS to a rig's config: `config_text(rotor)`, TOML to be read and completed by a person."""

import itertools
import json
import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rotorrig.rig.config import RPM
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.rotor import ROUNDING, BearingElement, DiskElement, Material, RossRotor, ShaftElement

STEPS = 10  # sections to a tapered element: the first frequency of tests/data/ross/tapered.toml to 4e-4
DIGITS = 12  # as many as a length summed from elements is good for
Keys = Iterator[str]


class Section(NamedTuple):
    """A stretch of one tube: as many elements as are alike, or a step of a tapered one."""

    first: str  # tag of its first element
    last: str
    length: float  # m
    diameter: float
    inner_diameter: float
    material: Material


def config_text(rotor: RossRotor, *, name: str, source: str, keep_nodes: bool = False) -> str:
    """Return the TOML of a rig called `name`, `source` saying where it came from.

    Adjacent elements of one tube and material become one section; with `keep_nodes` every element is a section, so
    that ROSS's nodes remain nodes. A pair of probes stands beside the first disk, to be moved where the real ones are.
    Raises ConfigError if the shaft's damping is not the same all along, or there is no disk.
    """
    if not rotor.disks:
        raise ConfigError(f"{source}: has no disk, want at least one")
    nodes = rotor.nodes
    tables = [
        _head(rotor, name=name, source=source),
        *_shaft(rotor, sections(rotor, keep_nodes=keep_nodes)),
        *(_disk(disk, nodes) for disk in rotor.disks),
        *(_bearing(bearing, nodes) for bearing in rotor.bearings),
        *_probes(nodes[rotor.disks[0].n]),
    ]
    return "\n\n".join(tables) + "\n"


def sections(rotor: RossRotor, *, keep_nodes: bool = False) -> list[Section]:
    """Return the stretches of the shaft from left to right, alike neighbours joined unless `keep_nodes`."""
    pieces = [piece for element in rotor.shaft for piece in _pieces(element)]
    if keep_nodes:
        return pieces
    groups = itertools.groupby(pieces, key=lambda p: (p.diameter, p.inner_diameter, p.material))
    return [_join(list(alike)) for _, alike in groups]


def _pieces(element: ShaftElement) -> Iterator[Section]:
    """Yield the element, or its steps if it is tapered: each as wide as the taper in the middle of the step."""
    (left, right), (bore_left, bore_right) = element.outer, element.inner
    steps = STEPS if element.tapered else 1
    for i in range(steps):
        along = (i + 0.5) / steps
        yield Section(
            first=element.tag,
            last=element.tag,
            length=element.length / steps,
            diameter=left + along * (right - left),
            inner_diameter=bore_left + along * (bore_right - bore_left),
            material=element.material,
        )


def _join(alike: Sequence[Section]) -> Section:
    length = round(sum(piece.length for piece in alike), ROUNDING)
    return alike[0]._replace(last=alike[-1].last, length=length)


def _head(rotor: RossRotor, *, name: str, source: str) -> str:
    lines = [
        f"# The rotor of {source}, saved by ROSS {rotor.version}.",
        "# Not in that file, to be added here: probes and keyphasor as they are, [motor], [daq], [limits], [plans] and",
        "# [identify]; a disk's width and diameter for the drawing, its expected unbalance.",
        *(line for note in rotor.notes for line in textwrap.wrap(f"# {note}", 118, subsequent_indent="#   ")),
        "#",
        "# Axes: z along the shaft from the coupling, x horizontal, y vertical, rotation from x towards y.",
        "",
        f"name = {_text(name)}",
    ]
    return "\n".join(lines)


def _shaft(rotor: RossRotor, stretches: Sequence[Section]) -> Iterator[str]:
    base = stretches[0].material
    uniform = _tube(stretches[0]) if len(stretches) == 1 else ()
    yield "\n".join(["[shaft]", *uniform, *_material(base), *_rayleigh(rotor)])
    if len(stretches) > 1:
        for stretch in stretches:
            elements = _text(stretch.first) + (f" to {_text(stretch.last)}" if stretch.last != stretch.first else "")
            own = _material(stretch.material) if stretch.material != base else ()
            yield "\n".join([f"[[shaft.sections]] # {elements}", *_tube(stretch), *own])


def _tube(stretch: Section) -> Keys:
    yield f"length = {_length(stretch.length)}"
    yield f"diameter = {_length(stretch.diameter)}"
    if stretch.inner_diameter:
        yield f"inner_diameter = {_length(stretch.inner_diameter)}"


def _material(material: Material) -> Keys:
    yield f"density = {_quantity(material.density, 'kg/m^3')}"
    yield f"youngs_modulus = {_quantity(material.youngs_modulus * 1e-9, 'GPa')}"
    yield f"poisson_ratio = {material.poisson_ratio:.{DIGITS}g}"


def _rayleigh(rotor: RossRotor) -> Keys:
    first = rotor.shaft[0]
    for element in rotor.shaft:
        if (element.alpha, element.beta) != (first.alpha, first.beta):
            raise ConfigError(
                f"'{element.tag}': alpha and beta are {element.alpha:g} and {element.beta:g}, want those of "
                f"'{first.tag}', {first.alpha:g} and {first.beta:g}: the shaft here has one damping"
            )
    if first.alpha or first.beta:
        mass, stiffness = _quantity(first.alpha, "1/s"), _quantity(first.beta, "s")
        yield f"rayleigh = {{ mass = {mass}, stiffness = {stiffness} }}"


def _disk(disk: DiskElement, nodes: Sequence[float]) -> str:
    lines = [
        f"[[disks]] # node {disk.n}",
        f"name = {_text(disk.tag)}",
        f"position = {_length(nodes[disk.n])}",
        f"mass = {_quantity(disk.mass, 'kg')}",
        f"polar_inertia = {_quantity(disk.polar_inertia, 'kg m^2')}",
        f"transverse_inertia = {_quantity(disk.transverse_inertia, 'kg m^2')}",
    ]
    return "\n".join(lines)


def _bearing(bearing: BearingElement, nodes: Sequence[float]) -> str:
    kind = "" if bearing.kind == "BearingElement" else f", {bearing.kind} as ROSS computed it"
    lines = [
        f"[[bearings]] # node {bearing.n}{kind}",
        f"name = {_text(bearing.tag)}",
        f"position = {_length(nodes[bearing.n])}",
    ]
    for key, values in bearing.coefficients.items():
        if any(values) or key in ("kxx", "kyy"):
            lines += _coefficient(key, bearing.frequency, values)
    return "\n".join(lines)


def _coefficient(key: str, frequency: Sequence[float], values: Sequence[float]) -> Keys:
    scale, unit = (1e-3, "kN/m") if key.startswith("k") else (1.0, "N s/m")
    written = [_quantity(value * scale, unit) for value in values]
    if all(value == values[0] for value in values):
        yield f"{key} = {written[0]}"
    else:
        yield f"{key}.speed = [{', '.join(_speeds(frequency))}]"
        yield f"{key}.value = [{', '.join(written)}]"


def _speeds(frequency: Sequence[float]) -> list[str]:
    """Return the speeds in rpm or rad/s, whichever are the rounder numbers."""
    rpm, rad = [_quantity(w * RPM, "rpm") for w in frequency], [_quantity(w, "rad/s") for w in frequency]
    return min(rpm, rad, key=lambda texts: len("".join(texts)))


def _probes(position: float) -> Iterator[str]:
    for channel, (name, angle) in enumerate((("x", 0), ("y", 90))):
        place = f"position = {_length(position)} # at the first disk: move it to where the probe is"
        yield "\n".join(["[[probes]]", f'name = "{name}"', place, f'angle = "{angle} deg"', f"channel = {channel}"])


def _length(metres: float) -> str:
    return _quantity(metres * 1e3, "mm")


def _quantity(value: float, unit: str) -> str:
    return f'"{value:.{DIGITS}g} {unit}"'


def _text(words: str) -> str:
    return json.dumps(words, ensure_ascii=False)  # TOML's basic strings have the same escapes
