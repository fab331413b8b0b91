"""The laws that effects state, as forces on the simulated rig's shaft: whether an effect follows its law in time.

The simulated rig's faults have mechanisms of their own; how far an effect is off those is no matter of how well it is
computed. Here a fault is given the effect's law, and nothing else of the effect: another mesh, and integration in time.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.faults.base import Values, load_fault
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, bend, law, sway
from rotorrig.sims.plant.places import bending_spans, sense, sought_bearings
from rotorrig.sims.plant.truth import Truth

#: where each fault of the simulated rig acts, and with what constants: of these laws only the law is another
OWN = {name: load_fault(name).forces for name in ("coupling", "crack", "friction")}


@contextmanager
def textbook_faults() -> Iterator[None]:
    """Let the simulated rig's faults of these names follow the laws below meanwhile."""
    with pytest.MonkeyPatch.context() as patch:
        for forces in (coupling, crack, cubic_spring, friction, shaft_asymmetry):
            patch.setattr(load_fault(forces.__name__), "forces", forces)
        yield


def coupling(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the coupling's force on the driven end of the shaft."""
    return tuple(replace(force, law=two_stiffnesses) for force in OWN["coupling"](rig, truth, values))


@law
def two_stiffnesses(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = bore force, bore angle, offset x, y, stiffness variation, stiff diameter."""
    bore_force, bore = p[0], turn.angle + p[1]
    bend_x, bend_y = p[2] - motion.x, p[3] - motion.y
    variation, stiff = p[4], turn.angle + p[5]
    c, s = math.cos(2.0 * stiff), math.sin(2.0 * stiff)
    fx = bore_force * math.cos(bore) + variation * (c * bend_x + s * bend_y)
    fy = bore_force * math.sin(bore) + variation * (s * bend_x - c * bend_y)
    return fx, fy


def crack(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the moment that the open crack does not carry."""
    return tuple(replace(force, law=hinge) for force in OWN["crack"](rig, truth, values))


@law
def hinge(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = stiffness lost when open, signed angle of the mouth.

    Slopes that fall along the shaft, towards the mouth, bulge it out on that side: the mouth is stretched and opens.
    """
    c, s = math.cos(turn.angle + p[1]), math.sin(turn.angle + p[1])
    towards = c * motion.x + s * motion.y
    if towards >= 0.0:
        return 0.0, 0.0
    return p[0] * towards * c, p[0] * towards * s


def shaft_asymmetry(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return what the stiff plane adds and the soft one lacks, beam element by beam element.

    An element between two places where forces act bends as one cubic but for the weight of the shaft itself.
    """
    cuts = (0.0, rig.shaft.length, *(d.position for d in rig.disks), *(b.position for b in rig.bearings))
    angle = sense(rig) * values["stiff_plane"]
    acting = []
    for start, end, stiffness in bending_spans(rig, truth, *cuts):
        k = values["asymmetry"] * stiffness / (end - start)
        acting.append(Force(on=bend(start, end), law=turning_spring, constants=(k, angle)))
        acting.append(Force(on=sway(start, end), law=turning_spring, constants=(3.0 * k, angle)))
    return tuple(acting)


@law
def turning_spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the moments in x and y; p = what the stiff plane has more than the mean, its signed angle."""
    c, s = math.cos(2.0 * (turn.angle + p[1])), math.sin(2.0 * (turn.angle + p[1]))
    return -p[0] * (c * motion.x + s * motion.y), -p[0] * (s * motion.x - c * motion.y)


def cubic_spring(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the cubic part of the springs of each bearing sought."""
    constants = (values["k3"],)
    return tuple(Force(on=at(b.position), law=cube, constants=constants) for b in sought_bearings(rig))


@law
def cube(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = k3."""
    k = p[0] * (motion.x * motion.x + motion.y * motion.y)
    return -k * motion.x, -k * motion.y


def friction(rig: RigConfig, truth: Truth, values: Values) -> tuple[Force, ...]:
    """Return the friction at each bearing sought, at ease where the shaft rests."""
    return tuple(replace(force, law=slider, memory=4) for force in OWN["friction"](rig, truth, values))


@law
def slider(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return (fx, fy) [N]; p = limit, stuck stiffness; remembers x, y and the force there."""
    fx = before[2] - p[1] * (motion.x - before[0])
    fy = before[3] - p[1] * (motion.y - before[1])
    size = math.hypot(fx, fy)
    if size > p[0]:
        fx, fy = fx * p[0] / size, fy * p[0] / size
    after[0], after[1], after[2], after[3] = motion.x, motion.y, fx, fy
    return fx, fy
