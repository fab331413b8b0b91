"""Force laws on the shaft: the places they act on, and the force by position and motion there.

A force acts through a `Place`, a weighted sum of deflections and slopes: that sum is the motion its law is given, and
its force spreads over them by the same weights, so that it does the work it should. A single deflection is a point of
the shaft; a slope takes a moment; the difference of two slopes is the bending in between, and takes a pair of moments.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from numba import njit, types
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Deflection:
    """The deflection of the shaft at a place [m from the coupling]."""

    position: float


@dataclass(frozen=True, slots=True)
class Slope:
    """The slope of the shaft, dx/dz and dy/dz, at a place [m from the coupling]."""

    position: float


Coordinate = Deflection | Slope
Place = tuple[tuple[Coordinate, float], ...]  # coordinates and their weights


class Turn(NamedTuple):
    """The end of a step; angle, speed and acceleration are signed, x to y positive."""

    t: float  # s
    angle: float  # rad
    omega: float  # rad/s
    alpha: float  # rad/s^2
    step: float  # s


class Motion(NamedTuple):
    """Position and velocity of a place: m and m/s, or their sum by its weights."""

    x: float
    y: float
    vx: float
    vy: float


_FLOATS = types.float64[::1]
_TURN = types.NamedUniTuple(types.float64, len(Turn._fields), Turn)
_MOTION = types.NamedUniTuple(types.float64, len(Motion._fields), Motion)
#: fx, fy [N, or N m on slopes] from the turn, the motion, the law's constants, its memory as the last step left it,
#: and that as this step leaves it, to be written in full by a law that has any
LAW = types.UniTuple(types.float64, 2)(_TURN, _MOTION, _FLOATS, _FLOATS, _FLOATS)


def law(function: Callable[..., tuple[float, float]]) -> Any:
    """Compile a force law (decorator); the integrator calls it in every iteration of every step."""
    return njit(LAW, cache=True)(function)


@dataclass(frozen=True, slots=True, kw_only=True)
class Force:
    """A force law acting on the shaft."""

    on: Place
    law: Callable[..., tuple[float, float]]  # made by `law`
    constants: tuple[float, ...]
    memory: int = 0  # floats the law remembers from step to step, zero at first
    from_rest: bool = False  # its motion counts from where the shaft rests under its weight, not from straight


def at(position: float) -> Place:
    """Return the point of the shaft at `position` [m from the coupling]."""
    return ((Deflection(position), 1.0),)


def tilt(position: float) -> Place:
    """Return the tilt of the shaft at `position` [m from the coupling]."""
    return ((Slope(position), 1.0),)


def bend(start: float, end: float) -> Place:
    """Return the angle by which the shaft bends from `start` to `end` [m from the coupling]."""
    return ((Slope(start), -1.0), (Slope(end), 1.0))


def sway(start: float, end: float) -> Place:
    """Return the part of a beam element's shape that `bend` leaves out: both ends' slopes against its chord.

    The strain energy of an element of length l is E I / (2 l) (bend^2 + 3 sway^2): Przemieniecki, Theory of Matrix
    Structural Analysis (1968), sec. 5.6, its stiffness matrix taken apart.
    """
    per_length = 2.0 / (end - start)
    return (
        (Slope(start), 1.0),
        (Slope(end), 1.0),
        (Deflection(start), per_length),
        (Deflection(end), -per_length),
    )


@law
def heavy_spot(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return the force of an unbalance p[0] [kg m] at p[1] [rad, signed], Re[(W^2 - j a) U e^{j psi} (1, -j)]."""
    psi = turn.angle + p[1]
    c, s = math.cos(psi), math.sin(psi)
    square = turn.omega * turn.omega
    return p[0] * (square * c + turn.alpha * s), p[0] * (square * s - turn.alpha * c)


@law
def turning_force(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    """Return a force of size p[0] that turns with the shaft at p[1] [rad, signed]."""
    return p[0] * math.cos(turn.angle + p[1]), p[0] * math.sin(turn.angle + p[1])
