"""Import of waveforms from universal files (UFF, UNV): data sets 58 and 58b of type 1, time response.

A data set is named by its response entity, its first line of identification or its node and direction ("1x", "2:+Y").
Its unit is the ordinate's label or, for a displacement without one, metres by data set 164. Other data sets are left
out. Field by field: https://www.ceas3.uc.edu/sdrluff, data set 58.
"""

import math
import os
from collections.abc import Iterator
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyuff
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.channels import Format
from rotorrig.acquisition.importers.signals import Signal, read_signals
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig

FORM = Format(name="UFF", channel="data set", unnamed="no data set 58 of a time response")
TIME_RESPONSE, UNITS, FUNCTION = 1, 164, 58
DISPLACEMENT, TIME = 8, (0, 1, 17)  # specific data types; 0 unknown and 1 general are often written for the time
DIGITS = 5e-6  # relative, of an abscissa printed as E13.5
JITTER = 0.25  # of a sample, of unevenly spaced abscissas, which are printed so too
_DIRECTIONS = {0: "", 1: "+X", -1: "-X", 2: "+Y", -2: "-Y", 3: "+Z", -3: "-Z"}


def read_uff(path: Path, rig: RigConfig, mapping: ChannelMapping | None = None) -> RawRecording:
    """Read a universal file of waveforms as the recording of a rig. Raises DataError for one that cannot be used."""
    if not path.is_file():
        raise DataError(f"{path}: cannot be read (it is not there, or no file)")
    file = _open_file(path)
    kinds = [int(kind) for kind in file.get_set_types()]
    length = next((_length_unit(path, file, n) for n, kind in enumerate(kinds) if kind == UNITS), None)
    signals = [
        _signal(path, file, n, head, length)
        for n, head in _heads(path, file, kinds)
        if head["func_type"] == TIME_RESPONSE
    ]
    return read_signals(path, rig, signals, mapping, form=FORM)


def _open_file(path: Path) -> Any:
    try:
        file = pyuff.UFF(str(path))
        sets = file.get_n_sets()
    except Exception as error:  # pyuff's are all plain Exception
        raise DataError(f"{path}: is no universal file ({error})") from error
    if not sets:
        raise DataError(f"{path}: is no universal file (no line with -1 begins and ends a data set)")
    if not _ending(path).endswith(b"-1"):
        raise DataError(f"{path}: is cut short, it ends in the middle of a data set")
    return file


def _ending(path: Path) -> bytes:
    with path.open("rb") as opened:
        opened.seek(-min(path.stat().st_size, 200), os.SEEK_END)
        return opened.read().rstrip()


def _heads(path: Path, file: Any, kinds: list[int]) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield number and header of every data set 58."""
    for n, kind in enumerate(kinds):
        if kind == FUNCTION:
            head = _read(path, file, n, header_only=True)
            if head["func_type"] == TIME_RESPONSE and head["ord_data_type"] not in (2, 4):
                raise DataError(f"{path}, data set {n + 1}: has an ordinate of type {head['ord_data_type']}, want real")
            yield n, head


def _read(path: Path, file: Any, n: int, *, header_only: bool = False) -> dict[str, Any]:
    try:
        read: dict[str, Any] = file.read_sets(n, header_only=header_only)
    except Exception as error:
        raise DataError(f"{path}, data set {n + 1}: cannot be read, want a data set {FUNCTION} or {UNITS}") from error
    return read


def _length_unit(path: Path, file: Any, n: int) -> str:
    """Return the unit of length by data set 164, as text: "1 m" if universal file units are SI."""
    factor = _read(path, file, n)["length"]  # file units / factor = SI
    if not 0 < factor < math.inf:
        raise DataError(f"{path}, data set {n + 1}: has a length factor of {factor}, want one above 0")
    return f"{1 / factor:.15g} m"


def _signal(path: Path, file: Any, n: int, head: dict[str, Any], length: str | None) -> Signal:
    where = f"{path}, data set {n + 1}"
    if head["abscissa_spec_data_type"] not in TIME:
        raise DataError(f"{where}: its abscissa is of type {head['abscissa_spec_data_type']}, want time (17)")
    if (label := _text(head, "abscissa_axis_units_lab")).lower() not in ("", "s", "sec", "seconds", "second"):
        raise DataError(f"{where}: its abscissa is in [{label}], want s")
    unit = _text(head, "ordinate_axis_units_lab")
    if not unit and head["ordinate_spec_data_type"] == DISPLACEMENT and length:
        unit = length
    even = head["abscissa_spacing"] == 1
    rate, start = _even_rate(where, head) if even else _uneven_rate(where, _read(path, file, n)["x"])
    return Signal(
        names=_names(head, n),
        unit=unit.removeprefix("1 "),
        rate=rate,
        start=start,
        samples=head["num_pts"],
        values=partial(_values, path, file, n),
    )


def _names(head: dict[str, Any], n: int) -> tuple[str, ...]:
    """Return what the data set may be called, what is most particular first."""
    direction = _DIRECTIONS.get(head.get("rsp_dir", 0), f"{head.get('rsp_dir')}")
    names = [_text(head, "rsp_ent_name"), _text(head, "id1"), f"{head.get('rsp_node', 0)}:{direction}"]
    return tuple(dict.fromkeys(name for name in names if name)) or (f"data set {n + 1}",)


def _text(head: dict[str, Any], field: str) -> str:
    """Return a field of text; "NONE" stands for none."""
    text = str(head.get(field, "")).strip()
    return "" if text.upper() == "NONE" else text


def _even_rate(where: str, head: dict[str, Any]) -> tuple[float, float]:
    """Return the sample rate [Hz] and the first time [s]."""
    step, start = head["abscissa_inc"], head["abscissa_min"]
    if not (0 < step < math.inf and math.isfinite(start)):
        raise DataError(f"{where}: has an abscissa from {start} by {step}, want times that rise evenly")
    return fewest_digits(1 / (step * (1 + DIGITS)), 1 / (step * (1 - DIGITS))), start


def _uneven_rate(where: str, x: NDArray[np.float64]) -> tuple[float, float]:
    """Return the sample rate of times written one by one: even, but for the digits they are printed with."""
    if len(x) < 3 or not np.isfinite(x).all() or not x[-1] > x[0]:
        raise DataError(f"{where}: has an abscissa that does not rise, want times of evenly spaced samples")
    rate = (len(x) - 1) / float(x[-1] - x[0])
    off = np.abs(x - x[0] - np.arange(len(x)) / rate) - DIGITS * np.abs(x)
    if (worst := float(off.max())) > JITTER / rate:
        raise DataError(f"{where}: has times up to {worst * 1e3:.3g} ms off an even {rate:.6g} Hz, want even ones")
    near = 2 * DIGITS
    return fewest_digits(rate * (1 - near), rate * (1 + near)), float(x[0])


def fewest_digits(low: float, high: float) -> float:
    """Return the number of fewest digits between `low` and `high`: an increment is printed with few of them.

    >>> fewest_digits(51199.7, 51200.3), fewest_digits(25599.9, 25600.1), fewest_digits(10240.4, 10240.6)
    (51200.0, 25600.0, 10240.5)
    """
    for digits in range(1, 16):
        unit = Decimal(10) ** (math.floor(math.log10(high)) + 1 - digits)
        nearest = (Decimal(low + high) / 2 / unit).to_integral_value() * unit
        if low <= nearest <= high:
            return float(nearest)
    return (low + high) / 2


def _values(path: Path, file: Any, n: int) -> NDArray[np.float64]:
    return np.asarray(_read(path, file, n)["data"], dtype=np.float64)
