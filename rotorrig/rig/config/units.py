"""Text with a unit to an SI number: "33.9 kN/m" to 33900.0.

`Annotated[float, reads("length")]` is a pydantic field; `to_si(text, "length")` the same as a function. A bare
number is refused, so that nobody has to guess; so is a speed in Hz (2 pi apart from rad/s, and pint would not object).
"""

import math
import re
from typing import Any

from pydantic import BeforeValidator, ValidationInfo

from rotorrig.rig.config.unit_registry import registry
from rotorrig.rig.errors import ConfigError

RPM = 30.0 / math.pi  # rpm per rad/s
UM = 1e6  # um per m

#: quantity -> (SI unit, an example to show in an error, the largest that is taken for more than a slip)
QUANTITIES: dict[str, tuple[str, str, float]] = {
    "length": ("m", "10 mm", 100.0),
    "mass": ("kg", "0.809 kg", 1e6),
    "inertia": ("kg m^2", "568.46e-6 kg m^2", 1e9),
    "density": ("kg/m^3", "7801 kg/m^3", 1e6),
    "modulus": ("Pa", "208.11 GPa", 1e15),
    "stiffness": ("N/m", "33.9 kN/m", 1e15),
    "tilt stiffness": ("N m/rad", "100 N m/rad", 1e12),
    "damping": ("N s/m", "15 N s/m", 1e12),
    "damping rate": ("1/s", "0.1 1/s", 1e9),
    "unbalance": ("kg m", "15 g mm", 1e3),
    "angle": ("rad", "45 deg", 1e6),
    "speed": ("rad/s", "480 rpm", 1e6),
    "ramp": ("rad/s^2", "30 rpm/s", 1e9),
    "time": ("s", "10 s", 1e10),
    "voltage": ("V", "-10 V", 1e6),
    "sensitivity": ("V/m", "7.874 mV/um", 1e12),
    "rate": ("Hz", "10 kHz", 1e9),
    "velocity": ("m/s", "1 mm/s", 1e6),
    "acceleration": ("m/s^2", "9.81 m/s^2", 1e6),
}
SMALLEST = 1e-30  # SI, of anything: what is less is 0, lest a square or a quotient of it leave the range of numbers
_ANGULAR = ("rpm", "rad", "deg", "revolution", "turn")
_LONGEST = 80  # characters; pint evaluates what it is given, so hostile text is kept from it
#: a power of something in brackets, or one that is not a whole number of one or two digits
_POWER = re.compile(r"\)\s*(?:\*\*|\^)|(?:\*\*|\^)(?!\s*-?\d{1,2}(?!\s*(?:[\d.^(]|\*\*)))")


def to_si(text: object, quantity: str) -> float:
    """Return `text` in the SI unit of `quantity`, a key of `QUANTITIES`.

    Raises ValueError, in one sentence, on a bare number, an unknown unit or a unit of something else.

    >>> to_si("33.9 kN/m", "stiffness")
    33900.0
    >>> to_si("60 Hz", "speed")
    Traceback (most recent call last):
    ValueError: got '60 Hz', want a shaft speed in rpm or rad/s (Hz could mean either), such as '480 rpm'
    """
    unit, example, _ = QUANTITIES[quantity]
    want = f"want {_a(quantity)} with its unit, such as '{example}'"
    if not isinstance(text, str):
        raise ValueError(f"got {text!r}, {want}")
    if len(text) > _LONGEST or _POWER.search(text):  # "9**9**9 m" would be worked out, for hours
        raise ValueError(f"got '{text[:_LONGEST]}', which is no number with a unit; {want}")
    try:
        value: Any = registry().Quantity(text)
    except Exception as error:  # pint raises a dozen kinds, tokenize's and its own
        raise ValueError(f"got '{text}', which is no number with a unit; {want}") from error
    if quantity in ("speed", "ramp") and not any(word in str(value.units) for word in _ANGULAR):
        raise ValueError(
            f"got '{text}', want a shaft speed in rpm or rad/s (Hz could mean either), such as '{example}'"
            if value.check("1/[time]") or value.check("1/[time]**2")
            else f"got '{text}', {want}"
        )
    if quantity == "rate" and any(word in str(value.units) for word in _ANGULAR):
        raise ValueError(f"got '{text}', want a rate in Hz, such as '{example}'")
    if value.unitless:
        raise ValueError(f"got '{text}' without a unit; {want}")
    if not value.is_compatible_with(unit):
        raise ValueError(f"got '{text}' ({value.units:~P}), {want}")
    try:
        number = float(value.to(unit).magnitude)
    except (ArithmeticError, TypeError, ValueError) as error:  # an integer beyond the range of numbers, a complex one
        raise ValueError(f"got '{text}', {want}") from error
    if not math.isfinite(number):
        raise ValueError(f"got '{text}', {want}")
    return _check_range(float(f"{number:.15g}"), quantity)  # 10 mm is 0.01 m, not 0.010000000000000002


def _check_range(number: float, quantity: str) -> float:
    """Return a number in SI, 0 if it is next to it. Raises ValueError for one too large to be meant."""
    unit, _, largest = QUANTITIES[quantity]
    if abs(number) > largest:
        raise ValueError(f"got {number:.4g} {unit}, want at most {largest:g} {unit}")
    return 0.0 if abs(number) < SMALLEST else number  # NaN stays, for the field to refuse


def read_quantity(text: str, quantity: str, *, where: str, positive: bool = False) -> float:
    """Return a text with a unit in SI. Raises ConfigError, with `where` it was written, as an option's name.

    >>> read_quantity("5 min", "time", where="--time-limit")
    300.0
    """
    try:
        value = to_si(text, quantity)
    except ValueError as error:
        raise ConfigError(f"{where}: {error}") from error
    if positive and not value > 0:
        raise ConfigError(f"{where}: got {text}, want {_a(quantity)} above zero")
    return value


def _a(noun: str) -> str:
    return f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"


def reads(quantity: str) -> BeforeValidator:
    """Return the validator of a pydantic field that holds `quantity` in SI and is written as text with a unit.

    A number is taken as SI only where the caller says so (`context={"si": True}`): our own files carry SI.
    """

    def validate(value: object, info: ValidationInfo) -> float:
        if info.context and info.context.get("si") and isinstance(value, (int, float)):
            try:
                return _check_range(float(value), quantity)
            except OverflowError as error:
                raise ValueError(f"got a number of {len(str(value))} digits, want one in SI") from error
        return to_si(value, quantity)

    return BeforeValidator(validate)


def reads_one_of(*quantities: str) -> BeforeValidator:
    """Return the validator of a field that holds an amount above 0 in SI and which of `quantities` it is of."""

    def validate(value: object) -> tuple[float, str]:
        faults = []
        for quantity in quantities:
            try:
                amount = to_si(value, quantity)
            except ValueError as error:
                faults.append(str(error))
                continue
            if not amount > 0:
                raise ValueError(f"got '{value}', want {_a(quantity)} above zero")
            return amount, quantity
        raise ValueError(f"{faults[0]}, or {' or '.join(map(_a, quantities[1:]))} with its unit")

    return BeforeValidator(validate)


def read_share(value: object) -> object:
    """Return a part of something, written as a number or in per cent, as a number. Raises ValueError.

    >>> read_share("0.2 %"), read_share(0.01)
    (0.002, 0.01)
    """
    if not isinstance(value, str):
        return value
    number, sign, rest = value.strip().partition("%")
    try:
        if sign and not rest:
            return float(f"{float(number) / 100:.15g}")  # 7 % is 0.07, not 0.07000000000000001
    except ValueError:
        pass
    raise ValueError(f"got '{value}', want a number such as 0.002, or text in per cent such as '0.2 %'")


def micrometres(length: float) -> str:
    """Return a length [m] in um for a sentence, to two figures or to the whole um: "0.39", "2.4", "152"."""
    value = length * UM
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.2g}"
