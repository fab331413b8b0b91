"""A CSV of waveforms into a RawRecording: a time column, the keyphasor and the config's probes, any unit they name.

    time [s], keyphasor [V], 1x [um], 1y [um]
    0.0000, -1.02, 12.3, -4.1

Columns are separated by commas, semicolons or tabs; those the config does not name are left out. A probe's column may
be volts, or a displacement towards the probe from where it reads its gap voltage.
"""

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.rig.description import Probe, RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance, code_version, file_hash
from rotorrig.rig.units import to_si

PIECE = 65536  # rows read at a time
RESOLUTION = 1e-9  # m, twice the rounding error of a displacement made counts
FINEST = 1e-6  # V per count at the most: 0.13 nm on an 8 mm probe, and a range of 2147 V
JITTER = 0.25  # of a sample: times are printed with few digits, a missing row is off by a whole one
FULL_SCALE = 2**31

_HEADING = re.compile(r"\s*(?P<name>[^\[\]]+?)\s*\[\s*(?P<unit>[^\[\]]+?)\s*\]\s*")


@dataclass(frozen=True, slots=True)
class Column:
    """One column that is read: value * factor + offset is seconds for the time, volts for the others."""

    name: str
    unit: str
    index: int
    factor: float
    offset: float = 0.0
    is_length: bool = False


def read_csv(path: Path, rig: RigConfig) -> RawRecording:
    """Read a CSV of waveforms, sampled evenly, as the recording of a rig.

    The file's numbers become int32 counts, exact to less than 1 nm or 1 uV. Raises DataError naming the row and
    column of whatever cannot be used; row 1 is the heading.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            heading = file.readline()
            delimiter = _delimiter(heading)
            columns = _columns(path, heading, delimiter, rig)
            pieces = list(_pieces(path, file, delimiter, columns))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: is not UTF-8 text, want a CSV file") from error
    rate, start = _sampling(path, [times for times, _ in pieces])
    info = _info(path, rig, rate)
    return RawRecording(
        rig=rig,
        daq=info,
        blocks=tuple(_blocks(path, [volts for _, volts in pieces], columns, rig, info)),
        events=(Event(t_ns=0, kind="note", text=_assumed(path, columns, rig, rate, start)),),
        motor=(),
        source=Provenance(
            config_hash=rig.hash, code_version=code_version(), source=path.name, source_hash=file_hash(path)
        ),
        complete=True,
    )


def _delimiter(heading: str) -> str:
    return max(",;\t", key=heading.count)


def _columns(path: Path, heading: str, delimiter: str, rig: RigConfig) -> tuple[Column, ...]:
    """Return the time column, then those of the config's channels: keyphasor first, probes in its order."""
    found: dict[str, tuple[int, str]] = {}
    for index, cell in enumerate(heading.split(delimiter)):
        if (match := _HEADING.fullmatch(cell.strip().strip('"'))) is None:
            continue
        if match["name"] in found:
            raise DataError(f"{path}, row 1: two columns are named '{match['name']}', want one")
        found[match["name"]] = (index, match["unit"])
    wanted = ["time", *(["keyphasor"] if rig.keyphasor else []), *(probe.name for probe in rig.probes)]
    if missing := [name for name in wanted if name not in found]:
        has = ", ".join(f"'{name}'" for name in found) or "no heading of the form 'name [unit]'"
        raise DataError(f"{path}, row 1: has no column '{missing[0]} [unit]', the config wants it; the file has {has}")
    probes = {probe.name: probe for probe in rig.probes}
    return tuple(_column(path, name, *found[name], probe=probes.get(name)) for name in wanted)


def _column(path: Path, name: str, index: int, unit: str, *, probe: Probe | None) -> Column:
    try:
        if name == "time":
            return Column(name, unit, index, to_si(f"1 {unit}", "time"))
        if probe is None:
            return Column(name, unit, index, to_si(f"1 {unit}", "voltage"))
        try:
            return Column(name, unit, index, to_si(f"1 {unit}", "voltage"))
        except ValueError:
            factor = to_si(f"1 {unit}", "length") * probe.sensitivity
            return Column(name, unit, index, factor, probe.gap_voltage, is_length=True)
    except ValueError as error:
        wanted = {"time": "a time such as s or ms", "keyphasor": "V or mV"}.get(name, "V or a length such as um")
        raise DataError(f"{path}, row 1: column '{name}' is in [{unit}], want {wanted}") from error


def _pieces(
    path: Path, file: TextIO, delimiter: str, columns: Sequence[Column]
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Yield times [s] (row,) and volts (row, channel) of some rows at a time."""
    row = 2
    while lines := list(itertools.islice(file, PIECE)):
        filled = len(lines)
        while filled and not lines[filled - 1].strip():
            filled -= 1
        if filled < len(lines) and file.read().strip():  # blank lines may end a file, not part it
            raise DataError(f"{path}, row {row + filled}: is blank, want {len(columns)} numbers")
        lines = lines[:filled]
        if lines:
            values = _numbers(path, lines, row, delimiter, columns)
            with np.errstate(over="ignore"):  # too large a number is found, with its row, when it becomes counts
                scaled = values * [c.factor for c in columns] + [c.offset for c in columns]
            yield scaled[:, 0], scaled[:, 1:]
            row += len(lines)


def _numbers(path: Path, lines: list[str], row: int, delimiter: str, columns: Sequence[Column]) -> NDArray[np.float64]:
    """Return the wanted cells of `lines` as (row, column); `row` is the number of the first."""
    usecols = [c.index for c in columns]
    try:
        values = np.loadtxt(lines, delimiter=delimiter, usecols=usecols, ndmin=2, comments=None, dtype=np.float64)
    except ValueError:
        values = np.empty((0, 0))
    if len(values) == len(lines) and np.isfinite(values).all():
        return values
    raise DataError(_bad_cell(path, lines, row, delimiter, columns))


def _bad_cell(path: Path, lines: list[str], row: int, delimiter: str, columns: Sequence[Column]) -> str:
    """Find the first cell that is no number and say so."""
    for number, line in enumerate(lines, start=row):
        cells = line.split(delimiter)
        if not line.strip():
            return f"{path}, row {number}: is blank, want {len(columns)} numbers"
        for column in columns:
            if column.index >= len(cells):
                return f"{path}, row {number}: ends before column '{column.name}', want a number there"
            cell = cells[column.index].strip()
            if not _is_number(cell):
                got = f"'{cell}'" if cell else "an empty cell"
                return f"{path}, row {number}, column '{column.name}': got {got}, want a number such as -1.25"
    return f"{path}, rows {row} to {row + len(lines) - 1}: cannot be read, want one line per row"


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def _sampling(path: Path, pieces: list[NDArray[np.float64]]) -> tuple[float, float]:
    """Return the sample rate [Hz] and the first time [s]; every step must be the same to within the printed digits."""
    times = np.concatenate(pieces) if pieces else np.empty(0)
    if len(times) < 3:
        raise DataError(f"{path}: has {len(times)} rows of numbers, want waveforms")
    steps = np.diff(times)
    step = float(np.median(steps))
    if not step > 0:
        raise DataError(f"{path}, column 'time': does not rise from row to row, want times of evenly spaced samples")
    if len(uneven := np.flatnonzero(np.abs(steps - step) > JITTER * step)):
        row = int(uneven[0]) + 3  # the heading is row 1, the first step leads to the second row of numbers
        raise DataError(
            f"{path}, row {row}, column 'time': is {steps[uneven[0]] * 1e3:.6g} ms after the row before, "
            f"want {step * 1e3:.6g} ms as elsewhere; only evenly sampled waveforms can be read"
        )
    rate = (len(times) - 1) / float(times[-1] - times[0])
    drift = np.abs(times - times[0] - np.arange(len(times)) / rate)
    if (worst := float(drift.max())) > step / 2:
        raise DataError(
            f"{path}, row {int(drift.argmax()) + 2}, column 'time': is {worst * 1e3:.6g} ms off an even {rate:.6g} Hz, "
            "want one sample rate from the first row to the last"
        )
    return float(f"{rate:.9g}"), float(times[0])


def _info(path: Path, rig: RigConfig, rate: float) -> DaqInfo:
    channels = 1 + max([p.channel for p in rig.probes] + ([rig.keyphasor.channel] if rig.keyphasor else []))
    finest = [FINEST] * channels
    for probe in rig.probes:
        finest[probe.channel] = min(FINEST, RESOLUTION * probe.sensitivity)
    return DaqInfo(
        model="CSV import",
        serial=path.name,
        sample_rate=rate,
        channels=channels,
        volts_per_count=tuple(finest),
        full_scale_counts=FULL_SCALE,
    )


def _blocks(
    path: Path, pieces: list[NDArray[np.float64]], columns: Sequence[Column], rig: RigConfig, info: DaqInfo
) -> Iterator[Block]:
    """Yield each piece of volts (row, column) as counts in the config's channels; a channel without one is zero."""
    channels = [rig.keyphasor.channel] if rig.keyphasor else []
    channels += [probe.channel for probe in rig.probes]
    scale = np.array(info.volts_per_count)[channels]
    first = 0
    for volts in pieces:
        if len(beyond := np.argwhere(np.abs(volts) > (FULL_SCALE - 1) * scale)):
            row, column = first + int(beyond[0][0]) + 2, columns[1 + int(beyond[0][1])]
            raise DataError(
                f"{path}, row {row}, column '{column.name}': is too large for a signal in [{column.unit}], "
                f"want less than {FULL_SCALE * scale[beyond[0][1]]:.0f} V; is the unit right?"
            )
        counts = np.zeros((len(volts), info.channels), dtype=np.int32)
        counts[:, channels] = np.round(volts / scale)
        yield Block(counts=counts, first_sample=first, t_ns=round(first * 1e9 / info.sample_rate))
        first += len(volts)


def _assumed(path: Path, columns: Sequence[Column], rig: RigConfig, rate: float, start: float) -> str:
    """Say what the file did not: it goes into the recording."""
    units = ", ".join(f"{c.name} [{c.unit}]" for c in columns)
    lengths = [c.name for c in columns if c.is_length]
    said = f"imported from {path.name}: {units}; {rate:.9g} Hz from the time column, which began at {start:g} s"
    if lengths:
        said += (
            f"; {', '.join(lengths)} taken as displacement towards the probe from its gap voltage, "
            "made volts with the config's sensitivity"
        )
    return said + "; clipping cannot be seen in a CSV"
