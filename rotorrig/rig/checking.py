"""Check a table as a model, and say what is wrong with it in one sentence: file, key, got, wanted."""

import difflib
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from rotorrig.rig.errors import ConfigError
from rotorrig.rig.nameplate import NUMBER, TABLE

Table = TypeVar("Table", bound=BaseModel)


def checked(model: type[Table], table: object, *, where: str, context: dict[str, Any] | None = None) -> Table:
    """Validate `table` as `model`; raises ConfigError in one sentence: file, key, got, wanted."""
    try:
        return model.model_validate(table, context=context)
    except ValidationError as error:
        raise ConfigError(_sentence(model, error, where)) from error


def _sentence(model: type[BaseModel], error: ValidationError, where: str) -> str:
    faults = [
        fault | {"loc": tuple(step for step in fault["loc"] if step not in (NUMBER, TABLE))}
        for fault in error.errors()
        if fault["type"] != "default_factory_not_called"  # only follows from another fault
    ]
    # an unknown key explains the missing one beside it, so it speaks first
    fault = next((f for f in faults if f["type"] == "extra_forbidden"), faults[0])
    key = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in fault["loc"]).lstrip(".")
    match fault["type"]:
        case "missing":
            said = f"{key}: is missing"
        case "extra_forbidden":
            known = _keys_at(model, fault["loc"][:-1])
            near = difflib.get_close_matches(str(fault["loc"][-1]), known, n=1)
            hint = f"did you mean '{near[0]}'" if near else f"want one of {', '.join(known)}"
            said = f"{key}: unknown key, {hint}"
        case "value_error":
            said = (f"{key}: " if key else "") + str(fault["ctx"]["error"])
        case _:
            said = f"{key}: got {fault['input']!r}, {fault['msg'][:1].lower() + fault['msg'][1:]}"
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return f"{where}: {said}{more}"


def _keys_at(model: type[BaseModel], loc: tuple[int | str, ...]) -> list[str]:
    """Return the keys the table at `loc` may have."""
    current: Any = model
    for step in loc:
        if isinstance(current, type) and issubclass(current, BaseModel) and step in current.model_fields:
            current = _table_in(current.model_fields[str(step)].annotation)
    if isinstance(current, type) and issubclass(current, BaseModel):
        return list(current.model_fields)
    return []


def _table_in(annotation: Any) -> Any:
    """Return the model inside `tuple[Disk, ...]`, `Keyphasor | None`, `dict[str, Plan]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for a in get_args(annotation) if (found := _table_in(a))), None)
