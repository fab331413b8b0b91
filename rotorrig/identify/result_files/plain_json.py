"""Plain JSON of result files: strict, null for "not known" or infinite, arrays with their shape."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import DataError, Provenance, write_whole_text

FIT = "rotorrig fit"
DIAGNOSIS = "rotorrig diagnosis"
BALANCE = "rotorrig balance"
PREDICTION = "rotorrig prediction"
INVESTIGATION = "rotorrig investigation"
VERSIONS = {FIT: 1, DIAGNOSIS: 2, BALANCE: 2, PREDICTION: 1, INVESTIGATION: 1}
CONVENTIONS = "SI units; amplitudes 0-peak; z = 2 mean(x exp(-j theta)), theta = 0 at the keyphasor edge; lag = -arg z"


def pair(value: list[float] | None) -> tuple[float, float] | None:
    """Return two numbers, None for null."""
    return (float(value[0]), float(value[1])) if value else None


def infinite(value: float | None) -> float:
    """Return a number, infinity for null."""
    return math.inf if value is None else float(value)


def number(value: float | None) -> float:
    """Return a number, NaN for null."""
    return math.nan if value is None else float(value)


def finite(value: Any) -> Any:
    """Return `value` as strict JSON holds it, tables and lists throughout."""
    if isinstance(value, Mapping):
        return {str(name): finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(part) for part in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def fields_of(thing: object, names: str) -> dict[str, Any]:
    """Return the attributes of `thing` in `names`, separated by spaces, as strict JSON holds them."""
    return {name: finite(getattr(thing, name)) for name in names.split()}


def numbers_out(values: NDArray[np.float64]) -> dict[str, Any]:
    """Return shape and flat list: seven digits are a thousandth of the noise."""
    return {"shape": list(values.shape), "values": [finite(float(f"{v:.7g}")) for v in values.ravel()]}


def numbers_in(table: dict[str, Any]) -> NDArray[np.float64]:
    """Return the array of `numbers_out`."""
    return np.array([number(v) for v in table["values"]]).reshape(table["shape"])


def complex_out(z: NDArray[np.complex128]) -> dict[str, Any]:
    """Return a complex array as its parts."""
    return {"re": numbers_out(z.real), "im": numbers_out(z.imag)}


def complex_in(table: dict[str, Any]) -> NDArray[np.complex128]:
    """Return the array of `complex_out`."""
    return numbers_in(table["re"]) + 1j * numbers_in(table["im"])


def write_table(path: Path, kind: str, body: dict[str, Any], source: Provenance) -> None:
    """Write a file of a kind with its provenance. Raises DataError if it cannot be written."""
    made = {name: getattr(source, name) for name in ("config_hash", "code_version", "source", "source_hash")}
    table = {"kind": kind, "version": VERSIONS[kind], "conventions": CONVENTIONS, **body, "source": made}
    write_whole_text(path, json.dumps(table, allow_nan=False) + "\n")


def read_table(path: Path, kind: str) -> dict[str, Any]:
    """Read a file of a kind. Raises DataError naming the file if it is not one, or of another version."""
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, RecursionError) as error:
        raise DataError(f"{path}: is no JSON, want a {kind} file") from error
    if not isinstance(table, dict) or table.get("kind") != kind:
        raise DataError(f"{path}: is no {kind} file")
    if table.get("version") != VERSIONS[kind]:
        raise DataError(
            f"{path}: has version {table.get('version')!r}, this program reads {VERSIONS[kind]}; make it anew"
        )
    return table
