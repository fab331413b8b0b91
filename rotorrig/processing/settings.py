"""Settings of order tracking, checked when they are made, with the text forms of their parts."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple, Self, get_args

from rotorrig.processing.response import Method
from rotorrig.rig import ConfigError
from rotorrig.rig.config import read_quantity, to_si

ORDERS = (0.0, 0.5, 1.0, 2.0, 3.0)  # the gap, half and whole multiples of the speed that faults are known by
#: separation of neighbouring orders, whole ones included, times turns, that a method needs: Blackman's window is zero
#: from 3 on; a fit separates them from 1 on, where the noise of either rises by a seventh
ORDER_SEPARATION: dict[Method, float] = {"resampling": 3.0, "least-squares": 1.0, "vold-kalman": 1.0}
LONGEST = 10_000  # turns
HIGHEST = 100.0  # order


class SpeedWindow(NamedTuple):
    """Window of speeds from `low` to `high` [rad/s]."""

    low: float
    high: float

    @classmethod
    def read(cls, text: str, *, where: str) -> Self:
        """Return the window "200 to 400 rpm" says. Raises ConfigError."""
        first, to, last = (part.strip() for part in text.partition(" to "))
        if not to:
            raise ConfigError(f"{where}: got '{text}', want two speeds such as '200 to 400 rpm'")
        unit = last.lstrip("+-.0123456789eE ")
        try:
            low, high = (to_si(t, "speed") for t in (first if first.endswith(unit) else f"{first} {unit}", last))
        except ValueError as error:
            raise ConfigError(f"{where}: {error}") from error
        if not 0 <= low < high:
            raise ConfigError(f"{where}: got '{text}', want a lower speed and a higher one such as '200 to 400 rpm'")
        return cls(low, high)

    @classmethod
    def read_one_or_two(cls, text: str, *, where: str) -> Self:
        """Return the window of "200 to 400 rpm", or that of the one speed "3000 rpm". Raises ConfigError."""
        if " to " in text:
            return cls.read(text, where=where)
        speed = read_quantity(text, "speed", where=where, positive=True)
        return cls(speed, speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Spacing:
    """Spacing of rows, in speed [rad/s] or in time [s]."""

    of: Literal["speed", "time"]
    step: float

    @classmethod
    def read(cls, text: str, *, where: str) -> Self:
        """Return the spacing "10 rpm" or "0.5 s" says. Raises ConfigError."""
        of: Literal["speed", "time"] = "speed" if "rpm" in text or "rad" in text else "time"
        try:
            step = to_si(text, of)
        except ValueError:
            step = math.nan
        if not step > 0:
            raise ConfigError(f"{where}: got '{text}', want a step of speed or time such as '10 rpm' or '0.5 s'")
        return cls(of=of, step=step)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tracking:
    """Settings of order tracking. Raises ConfigError for settings no recording can be tracked with."""

    turns: int = 8  # of a row's window
    orders: tuple[float, ...] = ORDERS
    method: Method = "resampling"
    every: Spacing | None = None  # between the middles of rows; None: one after another
    slow_roll: SpeedWindow | None = None  # where the slow-roll vector is taken; None: in the run of that name

    def __post_init__(self) -> None:
        object.__setattr__(self, "orders", tuple(float(order) for order in self.orders))
        if self.method not in ORDER_SEPARATION:
            known = ", ".join(name for name in get_args(Method) if name in ORDER_SEPARATION)
            raise ConfigError(f"method: got '{self.method}', want one of {known}")
        if not 1 <= self.turns <= LONGEST or self.turns != int(self.turns):
            raise ConfigError(f"turns: got {self.turns}, want a whole number from 1 to {LONGEST}")
        if not self.orders or len(set(self.orders)) < len(self.orders):
            raise ConfigError(
                f"orders: got {_join_orders(self.orders)}, want one or more, each once, such as 0, 0.5, 1, 2"
            )
        for order in self.orders:
            if not abs(order) <= HIGHEST:  # NaN too
                raise ConfigError(f"orders: got {order:g}, want none above {HIGHEST:g}")
            self._check_separation(order)

    def _check_separation(self, order: float) -> None:
        """Raise ConfigError if an order leaks into another or into a whole one, tracked or not."""
        beside = [abs(order - other) for other in (*self.orders, math.floor(order), math.ceil(order)) if other != order]
        apart = min([1.0, *beside])
        if self.turns * apart < ORDER_SEPARATION[self.method] * (1 - 1e-9) or not self._fits(order, self.turns):
            enough = math.ceil(ORDER_SEPARATION[self.method] / apart - 1e-9)
            while not self._fits(order, enough) and enough < LONGEST:
                enough += 1
            raise ConfigError(
                f"orders: rows of {self.turns} turns cannot tell order {order:g} from its neighbours"
                + (f", want turns = {enough} or a multiple of it" if enough < LONGEST else "")
                + (", or the method least-squares" if self._fit_suffices(apart) else "")
            )

    def _fits(self, order: float, turns: int) -> bool:
        """Return True if the method can track the order over so many turns: resampling needs whole periods of it."""
        return self.method != "resampling" or abs(turns * order - round(turns * order)) < 1e-9

    def _fit_suffices(self, apart: float) -> bool:
        return self.method == "resampling" and self.turns * apart >= ORDER_SEPARATION["least-squares"]


USUAL = Tracking()


def read_orders(text: str, *, where: str) -> tuple[float, ...]:
    """Return the orders "0, 0.5, 1" says. Raises ConfigError.

    >>> read_orders("0,0.5, 1X", where="--orders")
    (0.0, 0.5, 1.0)
    """
    try:
        return tuple(float(part.strip().rstrip("Xx")) for part in text.split(","))
    except ValueError as error:
        raise ConfigError(f"{where}: got '{text}', want numbers such as '0, 0.5, 1, 2, 3'") from error


def _join_orders(orders: tuple[float, ...]) -> str:
    return ", ".join(f"{order:g}" for order in orders) or "none"
