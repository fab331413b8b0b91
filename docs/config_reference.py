"""docs/config.md: every key of a config with type, unit, default and meaning, read from the checked tables themselves.

A table's sentence is its class's docstring, a key's meaning the comment beside its field.
"""

import inspect
import textwrap
import types
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import annotated_types
from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from docs.field_comments import comments
from rotorrig.rig.config import RigConfig
from rotorrig.rig.config.unit_registry import registry
from rotorrig.rig.config.units import QUANTITIES

HEAD = """# Every key of a config

Written by `make docs` from the code that checks a config; do not edit. How to write one is in
[bring your own rig](your-rig.md).

A quantity is text with a unit, `"33.9 kN/m"`: any unit of that dimension is accepted; a speed is in rpm or rad/s, never
in Hz. The program and its files use the SI unit given, as does a config with `units = "SI"` at the top, which accepts
bare numbers. Amplitudes are 0-peak. A key that is not in these tables is refused by name.
"""

#: quantity -> the unit a default is shown in, where it is not that of the example in an error
SHOWN = {"length": "um", "unbalance": "g mm", "stiffness": "N/m", "angle": "deg", "time": "s"}
PLACES = 4  # digits of a default
NUMBERS = {float: "number", int: "whole number", str: "text", bool: "`true` or `false`"}
NAME = "NAME"


def text() -> str:
    """Return the whole page."""
    parts = [_section("Top level", RigConfig, '`units = "SI"` may stand here too.')]
    tables: dict[type[BaseModel], list[str]] = {}
    for heading, model in _tables(RigConfig, ""):
        tables.setdefault(model, []).append(heading)
    parts += [_section(" and ".join(headings), model, "") for model, headings in tables.items()]
    return HEAD + "\n" + "\n".join(parts)


def _tables(model: type[BaseModel], path: str) -> Iterator[tuple[str, type[BaseModel]]]:
    """Yield heading and model of every table inside one, from the top of a config downwards."""
    for name, field in model.model_fields.items():
        for inner, shape in _models(field.annotation):
            key = f"{path}{name}"
            heading = {"list": f"`[[{key}]]`", "dict": f"`[{key}.{NAME}]`"}.get(shape, f"`[{key}]`")
            yield heading + _which(inner), inner
            yield from _tables(inner, f"{key}.")


def _which(model: type[BaseModel]) -> str:
    """Return the key that chooses this table among several, as a config has it."""
    for key in ("driver", "kind"):
        if key in model.model_fields:
            (value,) = get_args(model.model_fields[key].annotation)
            return f' with `{key} = "{value}"`'
    return ""


def _models(annotation: Any, shape: str = "") -> Iterator[tuple[type[BaseModel], str]]:
    """Yield the tables an annotation may hold, and whether one stands in a list or under names."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, shape
        return
    origin = get_origin(annotation)
    shape = {tuple: "list", dict: "dict"}.get(origin, shape)
    for argument in get_args(annotation)[: 1 if origin is Annotated else None]:
        yield from _models(argument, shape)


def _section(heading: str, model: type[BaseModel], more: str) -> str:
    said = comments(model)
    lines = [f"## {heading}", "", more or textwrap.fill(_docstring(model), 120)]
    lines += ["", "| key | what it takes | default | |", "|---|---|---|---|"]
    for name, field in model.model_fields.items():
        taken = taken_by(field.annotation, field.metadata)
        lines.append(f"| `{name}` | {taken} | {default_of(field)} | {said.get(name, '')} |".replace("|  |", "| |"))
    return "\n".join(lines) + "\n"


def _docstring(model: type[BaseModel]) -> str:
    return " ".join(inspect.cleandoc(model.__doc__ or "").split())


def taken_by(annotation: Any, metadata: Sequence[Any] = ()) -> str:
    """Return in words what a key takes: 'length [m], above 0'."""
    bounds = _bounds(metadata)
    return _kind(annotation, metadata) + (f", {bounds}" if bounds else "")


def _kind(annotation: Any, metadata: Sequence[Any]) -> str:
    if quantity := quantity_of(metadata):
        return f"{quantity} [{QUANTITIES[quantity][0]}]"
    origin, inner = get_origin(annotation), get_args(annotation)
    if annotation in NUMBERS:
        return NUMBERS[annotation]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return "table, below"
    if origin is Annotated:
        return taken_by(inner[0], _flat(inner[1:]))
    if origin is Literal:
        return ", ".join(f"`{_toml(value)}`" for value in inner)
    if origin in (Union, types.UnionType):
        return " or ".join(dict.fromkeys(taken_by(one) for one in inner if one is not type(None)))
    if origin is dict:
        return "tables by name, below" if list(_models(inner[1])) else f"table, name = {taken_by(inner[1])}"
    assert origin is tuple, annotation
    if list(_models(inner[0])):
        return "tables, below"
    if inner[-1] is Ellipsis:
        return f"list of {taken_by(inner[0])}"
    return f"`[low, high]`, each {taken_by(inner[0])}"


def quantity_of(metadata: Sequence[Any]) -> str:
    """Return the quantity that a field's text is read as, "" for none."""
    for each in metadata:
        if isinstance(each, BeforeValidator):
            closure = inspect.getclosurevars(each.func).nonlocals  # of units.reads
            if "quantity" in closure:
                return str(closure["quantity"])
    return ""


def _flat(metadata: Sequence[Any]) -> list[Any]:
    """Return metadata with that of `Field(...)` laid out beside it."""
    return [part for each in metadata for part in (each.metadata if isinstance(each, FieldInfo) else [each])]


def _bounds(metadata: Sequence[Any]) -> str:
    said = []
    for each in _flat(metadata):
        match each:
            case annotated_types.Gt(gt=low):
                said.append(f"above {low:g}")
            case annotated_types.Ge(ge=low):
                said.append(f"{low:g} or more")
            case annotated_types.Lt(lt=high):
                said.append(f"below {high:g}")
            case annotated_types.Le(le=high):
                said.append(f"{high:g} or less")
            case annotated_types.MinLen(min_length=count):
                said.append(f"at least {count}")
    return ", ".join(said)


def default_of(field: FieldInfo) -> str:
    """Return the value a key has when it is left out, as a config would write it."""
    if field.is_required():
        return "required"
    if field.default is PydanticUndefined:
        return "none" if field.default_factory is dict else "from other keys"
    if isinstance(field.default, BaseModel):
        return "as below"
    if field.default in (None, "", ()):
        return "none"
    return f"`{_written(field.default, _quantity_within(field.annotation, field.metadata))}`"


def _quantity_within(annotation: Any, metadata: Sequence[Any]) -> str:
    """Return the quantity of a key, or of the numbers in its list."""
    found = quantity_of(metadata)
    if found or annotation is None:
        return found
    if get_origin(annotation) is Annotated:
        first, *rest = get_args(annotation)
        return _quantity_within(first, rest)
    return next((q for one in get_args(annotation) if (q := _quantity_within(one, ()))), "")


def _written(value: Any, quantity: str) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_written(each, quantity) for each in value)}]"
    if not quantity:
        return _toml(value)
    unit, example, _ = QUANTITIES[quantity]
    shown = SHOWN.get(quantity, example.split(" ", maxsplit=1)[1])
    if shown == "um" and (abs(value) >= 1e-3 or not value):
        shown = "mm"
    return f'"{registry().Quantity(value, unit).to(shown).magnitude:.{PLACES}g} {shown}"'


def _toml(value: object) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else f"{value:g}"
