"""How large a fault of a blind case may be: what each fault's `RANGE` is made of."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rotorrig.rig.config import RigConfig


class Range(Protocol):
    """Where a parameter of a blind case is drawn from."""

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for that rig."""
        ...


@dataclass(frozen=True, slots=True)
class LogUniform:
    """As many below the geometric mean as above: for sizes, which reach down to what nobody could see."""

    low: float
    high: float
    either_sign: bool = False

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        size = math.exp(rng.uniform(math.log(self.low), math.log(self.high)))
        return size * float(rng.choice([-1.0, 1.0])) if self.either_sign else size


@dataclass(frozen=True, slots=True)
class Uniform:
    """Evenly between two values."""

    low: float
    high: float

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        return float(rng.uniform(self.low, self.high))


ANY_PHASE = Uniform(-math.pi, math.pi)


@dataclass(frozen=True, slots=True)
class AnyProbe:
    """The number of one of the rig's probes."""

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a number for that rig."""
        return float(rng.integers(len(rig.probes)))


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of a few values, each as likely."""

    values: tuple[float, ...]

    def draw(self, rig: RigConfig, rng: np.random.Generator) -> float:
        """Return a value for any rig."""
        return float(rng.choice(self.values))
