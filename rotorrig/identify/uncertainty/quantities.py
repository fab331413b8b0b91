"""Sought quantities as functions of the parameter vector of a fit: a coordinate each, in which intervals are set.

Coefficients, modulus and density have their working coordinate (unknowns.py: the logarithm of what cannot be negative),
an unbalance its amount and its phase, though the fit itself moves its real and imaginary parts.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rotorrig.identify.base_model import Parameters, Reals, Space


class Quantity(Protocol):
    """A sought quantity. `low` and `high` confine its coordinate."""

    @property
    def name(self) -> str:
        """That of the estimate."""

    @property
    def low(self) -> float:
        """Lower bound of the coordinate."""

    @property
    def high(self) -> float:
        """Upper bound of the coordinate."""

    def read(self, p: Reals) -> float:
        """Return the coordinate at `p` (parameter,)."""

    def gradient(self, p: Reals) -> Reals:
        """Return d coordinate / d p, (parameter,)."""

    def scale(self, p: Reals) -> float:
        """Return the change of the coordinate that is large at `p`."""

    def si(self, coordinate: float) -> float:
        """Return the SI value of a coordinate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coefficient:
    """A coefficient of a bearing, or of the shaft: its coordinate is a parameter of the fit."""

    name: str
    index: int
    space: Space

    @property
    def axes(self) -> str:
        """Along which it acts: "xx", "xy"..; empty for the shaft's."""
        return self.space.unknowns[self.index].axes

    @property
    def low(self) -> float:
        """The config's lower bound."""
        return float(self.space.working_bounds[self.index, 0])

    @property
    def high(self) -> float:
        """The config's upper bound."""
        return float(self.space.working_bounds[self.index, 1])

    def read(self, p: Reals) -> float:
        """Return the parameter."""
        return float(p[self.index])

    def gradient(self, p: Reals) -> Reals:
        """Return a unit vector."""
        slope = np.zeros(len(p))
        slope[self.index] = 1.0
        return slope

    def scale(self, p: Reals) -> float:
        """Return a factor of e, or for a cross coefficient its bearing's direct ones."""
        values = self.space.from_working(p[: len(self.space)])
        return float((self.space.references(values) / self.space.slopes(values))[self.index])

    def si(self, coordinate: float) -> float:
        """Return the SI value of a coordinate."""
        return float(self.space.from_working(np.full(len(self.space), coordinate))[self.index])


@dataclass(frozen=True, slots=True, kw_only=True)
class Amount:
    """Amount of an unbalance [kg m]."""

    name: str
    at: slice  # of its re and im
    low: float = 0.0
    high: float = np.inf

    def read(self, p: Reals) -> float:
        """Return the amount."""
        return abs(complex(*p[self.at]))

    def gradient(self, p: Reals) -> Reals:
        """Return the direction of the unbalance, which must not be zero."""
        slope = np.zeros(len(p))
        slope[self.at] = p[self.at] / self.read(p)
        return slope

    def scale(self, p: Reals) -> float:
        """Return the amount itself."""
        return self.read(p)

    def si(self, coordinate: float) -> float:
        """Return the same."""
        return coordinate


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """Phase of an unbalance [rad], within half a turn of `origin`."""

    name: str
    at: slice  # of its re and im
    origin: float

    @property
    def low(self) -> float:
        """Half a turn before."""
        return self.origin - np.pi

    @property
    def high(self) -> float:
        """Half a turn after."""
        return self.origin + np.pi

    def read(self, p: Reals) -> float:
        """Return the phase."""
        return self.origin + float(np.angle(complex(*p[self.at]) * np.exp(-1j * self.origin)))

    def gradient(self, p: Reals) -> Reals:
        """Return the direction across the unbalance, which must not be zero."""
        re, im = p[self.at]
        slope = np.zeros(len(p))
        slope[self.at] = np.array([-im, re]) / (re**2 + im**2)
        return slope

    def scale(self, p: Reals) -> float:
        """Return a radian."""
        return 1.0

    def si(self, coordinate: float) -> float:
        """Return the same."""
        return coordinate


def quantities(parameters: Parameters, p: Reals) -> tuple[Quantity, ...]:
    """Return what a fit with optimum `p` seeks, in the order of its estimates."""
    space = parameters.space
    sought: list[Quantity] = [Coefficient(name=name, index=i, space=space) for i, name in enumerate(space.names)]
    for i, amount in enumerate(space.amounts):
        first = parameters.unbalance.start + 2 * i
        at = slice(first, first + 2)
        phase = "phase" + amount.name.removeprefix("u")
        sought += [
            Amount(name=amount.name, at=at),
            Phase(name=phase, at=at, origin=float(np.angle(complex(*p[at])))),
        ]
    return tuple(sought)
