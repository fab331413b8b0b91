"""Seal a truth into a JSON file before a sweep; unseal it to score a diagnosis."""

import json
import math
from dataclasses import asdict, fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from rotorrig.rig import DataError, write_whole_text
from rotorrig.sims.plant.faults import check_faults
from rotorrig.sims.plant.truth import Geometry, Truth, Unmodelled

SCHEMA = "rotorrig.plant.truth/2"


def seal(truth: Truth, path: Path) -> None:
    """Write `truth` to a JSON file. Raises DataError if it cannot be written."""
    write_whole_text(path, json.dumps({"schema": SCHEMA, **asdict(truth)}, indent=1) + "\n")


def unseal(path: Path) -> Truth:
    """Read a sealed truth back. Raises DataError, in one sentence, on a file that holds none."""
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}), want a sealed truth in JSON") from error
    except ValueError as error:
        raise DataError(f"{path}: is no JSON ({error}), want a sealed truth") from error
    if not isinstance(table, dict) or table.get("schema") != SCHEMA:
        got = table.get("schema", "no schema") if isinstance(table, dict) else f"a JSON {type(table).__name__}"
        raise DataError(f"{path}: holds {got}, want a sealed truth of schema {SCHEMA}")
    del table["schema"]
    for name, none in (("unmodelled", asdict(Unmodelled())), ("geometry", asdict(Geometry()))):
        if isinstance(got := table.get(name, {}), dict):
            table[name] = none | got  # older ones had less
    try:
        truth: Truth = _decode(Truth, table, "truth")
        check_faults(truth.faults)
    except (ValueError, DataError) as error:
        raise DataError(f"{path}: is no usable truth: {error}") from error
    return truth


def _decode(kind: Any, value: Any, where: str) -> Any:
    """Return JSON `value` as `kind`: a dataclass of ours, a tuple, a dict or a scalar. Raises ValueError."""
    if isinstance(kind, type) and is_dataclass(kind):
        return _decode_dataclass(kind, value, where)
    origin, inner = get_origin(kind), get_args(kind)
    if origin is tuple and isinstance(value, (list, tuple)):
        kinds = inner[:1] * len(value) if inner[-1] is Ellipsis else inner
        if len(kinds) == len(value):
            return tuple(_decode(k, v, f"{where}[{i}]") for i, (k, v) in enumerate(zip(kinds, value, strict=True)))
    elif origin is dict and isinstance(value, dict):
        return {key: _decode(inner[1], v, f"{where}.{key}") for key, v in value.items()}
    elif kind is float and isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    elif kind in (str, int, int | None) and isinstance(value, kind) and not isinstance(value, bool):
        return value
    raise ValueError(f"{where} is {json.dumps(value)[:60]}, want {getattr(kind, '__name__', kind)}")


def _decode_dataclass(kind: type, value: Any, where: str) -> Any:
    names = {f.name for f in fields(kind)}
    if not isinstance(value, dict):
        raise ValueError(f"{where} is a {type(value).__name__}, want a table")
    if odd := names.symmetric_difference(value):
        name = min(odd)
        raise ValueError(f"{where}.{name} {'is missing' if name in names else 'is none of its keys'}")
    hints = get_type_hints(kind)
    return kind(**{name: _decode(hints[name], value[name], f"{where}.{name}") for name in names})
