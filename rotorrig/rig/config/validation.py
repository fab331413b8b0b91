"""Validation of a table as a model, with errors in one sentence: file, key, got, wanted."""

import difflib
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from rotorrig.rig.config.nameplate import NUMBER, TABLE
from rotorrig.rig.errors import ConfigError

_LONGEST = 80  # characters of a key that are compared

Table = TypeVar("Table", bound=BaseModel)


def validate_table(model: type[Table], table: object, *, where: str, context: dict[str, Any] | None = None) -> Table:
    """Validate `table` as `model`; raises ConfigError in one sentence: file, key, got, wanted."""
    try:
        return model.model_validate(table, context=context)
    except ValidationError as error:
        raise ConfigError(_sentence(model, error, where)) from error


def _sentence(model: type[BaseModel], error: ValidationError, where: str) -> str:
    faults = [
        fault for fault in error.errors() if fault["type"] != "default_factory_not_called"
    ]  # follows from another
    # an unknown key explains the missing one beside it, so it speaks first
    fault = next((f for f in faults if f["type"] == "extra_forbidden"), faults[0])
    place, around, inside = _resolve(model, fault["loc"])
    key = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in place).lstrip(".")
    match fault["type"]:
        case "missing":
            sentence = f"{key}: is missing"
        case "extra_forbidden":
            known = [name for table in around for name in table.model_fields]
            sentence = f"{key}: unknown key, {_hint(str(place[-1]), known)}"
        case "union_tag_not_found":
            sentence = f"{key}.{_discriminator(fault)}: is missing, want one of {', '.join(_tags(*inside))}"
        case "union_tag_invalid":
            got = fault["ctx"]["tag"]
            sentence = f"{key}.{_discriminator(fault)}: got '{got}', {_hint(got, _tags(*inside))}"
        case "value_error":
            sentence = (f"{key}: " if key else "") + str(fault["ctx"]["error"])
        case _:
            sentence = f"{key}: got {fault['input']!r}, {fault['msg'][:1].lower() + fault['msg'][1:]}"
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return f"{where}: {sentence}{more}"


def _hint(got: str, known: list[str]) -> str:
    got = got[:_LONGEST]  # the search takes time with the square of its length
    near = difflib.get_close_matches(got, known, n=1)
    return f"did you mean '{near[0]}'" if near else f"want one of {', '.join(known)}"


def _discriminator(fault: Any) -> str:
    return str(fault["ctx"]["discriminator"]).strip("'")


def _resolve(
    model: type[BaseModel], loc: tuple[int | str, ...]
) -> tuple[list[int | str], list[type[BaseModel]], list[type[BaseModel]]]:
    """Return where `loc` is in the user's file, the tables around its last step and those inside it.

    Pydantic's `loc` also names which of several forms or tables it tried: no step a user wrote.
    """
    place: list[int | str] = []
    around: list[type[BaseModel]] = []
    here: Any = model
    for step in loc:
        tables = _tables_in(here)
        if step in (NUMBER, TABLE):
            continue
        if len(tables) > 1 and (chosen := next((t for t in tables if step in _tags(t)), None)):
            here = chosen
            continue
        around = tables
        here = next((t.model_fields[str(step)].annotation for t in tables if step in t.model_fields), here)
        place.append(step)
    return place, around, _tables_in(here)


def _tags(*tables: type[BaseModel]) -> list[str]:
    """Return the words that choose between tables: the values of their `driver` or `kind`."""
    fields = (table.model_fields.get(name) for table in tables for name in ("driver", "kind"))
    return [word for field in fields if field for word in get_args(field.annotation)]


def _tables_in(annotation: Any) -> list[type[BaseModel]]:
    """Return the models inside `tuple[Disk, ...]`, `Keyphasor | None`, `dict[str, Plan]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [table for inner in get_args(annotation) for table in _tables_in(inner)]
