"""The signatures in docs/effects.md: a picture for every file of sims/effects, and the lines that show it.

What is drawn is the forward model of configs/rk4.toml, with its nameplate's unbalance alone and with the effect beside
it. An effect is drawn at its first place and at the size typical of it; `DRAWN` holds those that tell more elsewhere,
or larger.
"""

import cmath
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from docs.effect_response import Sweep, vectors
from docs.signature_drawing import Signature, drawn
from docs.svg_plot import Figure
from rotorrig.rig.config import RigConfig, load
from rotorrig.sims.effects import Effect, catalogue, find

ROOT = Path(__file__).parents[1]
PARAGRAPH = re.compile(r"^\*\*(\w+)\*\* – .*?(?=\n\n)", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"^!\[[^\]]*\]\(img/effect-\w+\.svg\)\n\n", re.MULTILINE)
ANGLE = math.radians(60.0)  # of a phasor, from the keyphasor mark


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Where an effect is drawn, how large, and on what rotor; what is left out is as by default."""

    where: str = ""  # its place, as in its label
    larger: float = 1.0  # times its typical size
    values: Mapping[str, float] = field(default_factory=dict)  # SI
    beside: str = ""  # another effect that the rotor has anyway


DRAWN: Mapping[str, Case] = {
    "clearance": Case(values={"gap": 20e-6}),
    "couple": Case(larger=5.0),
    "coupling": Case(values={"stiffness re": 0.0, "stiffness im": 0.0}),
    "crack": Case(values={"softness": 0.03, "mouth": ANGLE, "place": 0.25}),
    "cross_talk": Case(where="plane 1", larger=5.0),
    "cubic_spring": Case(values={"k3": 1e11}),
    "disk_inertia": Case(larger=6.0),
    "drag": Case(values={"c2": 80.0}),
    "friction": Case(values={"force": 0.4}),
    "internal_damping": Case(values={"beta": 1e-4, "exponent": 0.5}),
    "pedestal": Case(where="x", values={"lightness": 0.12, "omega": 176.0, "damping ratio": 0.04}),
    "probe_angle": Case(where="probe 1x", larger=2.0),
    "probe_gain": Case(where="probe 1x", larger=4.0),
    "rub": Case(where="at disk", values={"gap": 250e-6, "stiffness": 20e3}),
    "slow_roll_subtracted": Case(beside="bow"),
    "unbalance_plane": Case(where="at 400 mm"),
    "unbalance_step": Case(values={"time": 104.5}),  # at the top
}


def pictures() -> dict[str, Figure]:
    """Return every picture by its file name."""
    return {f"effect-{name}.svg": drawn(signature) for name, signature in signatures().items()}


@cache
def signatures() -> Mapping[str, Signature]:
    """Return what is to be drawn of every effect, by the name of its file."""
    rig, sweep = load(ROOT / "configs" / "rk4.toml"), Sweep.even()
    return {name: _signature(rig, name, sweep) for name in sorted({effect.name for effect in catalogue(rig)})}


def shown(text: str) -> str:
    """Return the text of effects.md with every picture behind the paragraph of its effect, and no other."""

    def with_picture(paragraph: re.Match[str]) -> str:
        name = paragraph[1]
        return f"{paragraph[0]}\n\n![{name}: {signatures()[name].words}](img/effect-{name}.svg)"

    return PARAGRAPH.sub(with_picture, PICTURE.sub("", text))


def _signature(rig: RigConfig, name: str, sweep: Sweep) -> Signature:
    case = DRAWN.get(name, Case())
    effect = _chosen(rig, name, case)
    theta = {**_typical(effect, case.larger), **case.values}
    always = find(rig, case.beside) if case.beside else None
    there = (always, _typical(always, 1.0)) if always else None
    said = f", on a rotor where {always.words(there[1])}" if always and there else ""
    return Signature(
        name=name,
        words=effect.words(theta) + said,
        without=vectors(rig, effect, effect.at_zero, sweep, beside=there),
        with_it=vectors(rig, effect, theta, sweep, beside=there),
    )


def _chosen(rig: RigConfig, name: str, case: Case) -> Effect:
    if case.where:
        return find(rig, f"{name}, {case.where}")
    return next(effect for effect in catalogue(rig) if effect.name == name)


def _typical(effect: Effect, larger: float) -> dict[str, float]:
    """Return every unknown at its typical size, a phasor as large as its parts are, at 60 degrees."""
    turned = cmath.rect(1.0, ANGLE)
    theta = {}
    for p in effect.parameters:
        part = turned.imag if p.name.endswith(" im") else turned.real if p.name.endswith(" re") else 1.0
        theta[p.name] = p.starts[0] if p.starts else p.at_zero + larger * part * p.size
    return theta
