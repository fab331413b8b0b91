"""Universal file data sets 58, 58b (function at nodal DOF) and 164 (units) as bytes.

Written here, as pyuff writes no order functions (type 27) and gives the byte count of half of a complex 58b. Records
and columns as in https://www.ceas3.uc.edu/sdrluff, data sets 58 and 164.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

TIME_RESPONSE, ORDER_FUNCTION = 1, 27  # function types
GENERAL, DISPLACEMENT, TIME, RPM, ORDER = 1, 8, 17, 19, 20  # specific data types
_ID_LINES, _ID_WIDTH, _NAME, _LABEL = 5, 80, 10, 20
_HEADER_LINES = 11  # of a 58b, before its bytes


@dataclass(frozen=True, slots=True)
class Axis:
    """Axis of a data set: specific data type, label, unit."""

    kind: int = 0
    label: str = ""
    unit: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """One data set. Its abscissa is `x`, or evenly spaced from `start` by `step`."""

    kind: int  # function type
    lines: tuple[str, ...]  # of identification, up to five of 80 characters
    name: str = ""  # of the response entity, up to ten characters
    node: int = 0
    direction: int = 0  # 1 +X, -1 -X, 2 +Y, -2 -Y, 0 none of them
    abscissa: Axis
    ordinate: Axis
    z_axis: Axis = field(default_factory=Axis)
    z_value: float = 0.0
    x: NDArray[np.float64] | None = None
    start: float = 0.0
    step: float = 0.0
    values: NDArray[Any]  # real or complex, written in double precision


def units_in_si() -> bytes:
    """Return data set 164 saying that lengths are metres."""
    numbers = "".join(f"{value:25.17E}".replace("E", "D") for value in (1.0, 1.0, 1.0))
    offset = f"{273.15:25.17E}".replace("E", "D")
    return _data_set(164, [f"{1:10d}{'SI: Meter (newton)':20s}{2:10d}", numbers, offset])


def ascii_function(function: Function) -> bytes:
    """Return data set 58, its numbers as text."""
    return _data_set(58, [*_records(function), *_number_lines(function)])


def binary_function(function: Function) -> bytes:
    """Return data set 58b with evenly spaced abscissa: little endian, IEEE 754."""
    data = np.ascontiguousarray(function.values)
    body = data.astype("<c16" if np.iscomplexobj(data) else "<f8").tobytes()
    first = f"{58:6d}b{1:6d}{2:6d}{_HEADER_LINES:12d}{len(body):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    head = "\n".join([f"{-1:6d}", first, *_records(function)]) + "\n"
    return head.encode("ascii") + body + f"{-1:6d}\n".encode("ascii")


def _data_set(number: int, lines: list[str]) -> bytes:
    text = "\n".join([f"{-1:6d}", f"{number:6d}", *lines, f"{-1:6d}"])
    return f"{text}\n".encode("ascii")


def _records(function: Function) -> list[str]:
    """Return records 1 to 11."""
    lines = [*function.lines, *[""] * _ID_LINES][:_ID_LINES]
    even = function.x is None
    kind = 6 if np.iscomplexobj(function.values) else 4
    step = f"{function.step:13.6e}" if even else f"{0.0:13.5e}"  # a digit more than usual, within its 13 columns
    start = function.start if even else 0.0
    return [
        *(_text(line, _ID_WIDTH) or "NONE" for line in lines),
        f"{function.kind:5d}{0:10d}{0:5d}{0:10d} {_text(function.name, _NAME) or 'NONE':10s}{function.node:10d}"
        f"{function.direction:4d} {'NONE':10s}{0:10d}{0:4d}",
        f"{kind:10d}{len(function.values):10d}{int(even):10d}{start:13.5e}{step}{function.z_value:13.5e}",
        *(_axis(axis) for axis in (function.abscissa, function.ordinate, Axis(), function.z_axis)),
    ]


def _axis(axis: Axis) -> str:
    label, unit = (_text(text, _LABEL) or "NONE" for text in (axis.label, axis.unit))
    return f"{axis.kind:10d}{0:5d}{0:5d}{0:5d} {label:20s} {unit:20s}"


def _text(text: str, width: int) -> str:
    """Return `text` as one line of ASCII that fits its columns."""
    plain = "".join(letter if " " <= letter <= "~" else "?" for letter in text.replace("\n", " "))
    return plain[:width].rstrip()


def _number_lines(function: Function) -> list[str]:
    """Return record 12 in the four double-precision forms."""
    values = function.values
    parts = [values.real, values.imag] if np.iscomplexobj(values) else [values]
    table = np.column_stack(parts if function.x is None else [function.x, *parts])
    if function.x is None:
        form, numbers = "%20.12E", table.ravel()
        return ["".join(form % number for number in numbers[at : at + 4]) for at in range(0, len(numbers), 4)]
    row = "%13.5E" + "%20.12E" * len(parts)
    per_line = 1 if len(parts) == 2 else 2
    rows = [row % tuple(line) for line in table.tolist()]
    return ["".join(rows[at : at + per_line]) for at in range(0, len(rows), per_line)]
