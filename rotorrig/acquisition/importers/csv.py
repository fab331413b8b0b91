"""Import of waveforms from CSV: a time column, the keyphasor and the config's probes, in any unit they name.

    time [s], keyphasor [V], 1x [um], 1y [um]
    0.0000, -1.02, 12.3, -4.1

Columns are separated by commas, semicolons or tabs; those the config does not name are left out. A probe's column may
be volts, or a displacement towards the probe from where it reads its gap voltage. Columns of other names, or without a
unit, need a mapping (`channel_mapping`).
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.channels import FileChannel, Format, find_channel, match_channels
from rotorrig.acquisition.importers.waveforms import make_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig, to_si

PIECE = 65536  # rows read at a time
JITTER = 0.25  # of a sample: times are printed with few digits, a missing row is off by a whole one
LONGEST = 2**20  # characters of a line
LONGEST_STEP = 1e6  # s

FORM = Format(
    name="CSV",
    channel="column",
    sample="row",
    first=2,
    heading=", row 1",
    example="{name} [unit]",
    unnamed="no heading of the form 'name [unit]'",
)


@dataclass(frozen=True, slots=True)
class Column:
    """Column to be read; `factor` turns its times into seconds."""

    name: str
    index: int
    factor: float = 1.0


def read_csv(path: Path, rig: RigConfig, mapping: ChannelMapping | None = None) -> RawRecording:
    """Read a CSV of evenly sampled waveforms as the recording of a rig.

    The file's numbers become int32 counts, exact to less than 1 nm or 1 uV. Raises DataError naming the row and
    column of whatever cannot be used; row 1 is the heading.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            heading = _heading(path, file)
            delimiter = _delimiter(heading)
            available = _offers(heading, delimiter, mapping)
            time = _time(path, available, mapping)
            channels = match_channels(path, rig, available, mapping, form=FORM)
            columns = ([time] if time else []) + [Column(c.name, c.index) for c in channels]
            pieces = list(_pieces(path, file, delimiter, columns))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: is not UTF-8 text, want a CSV file") from error
    rate, rate_source = _rate(path, pieces, time, mapping)
    values = [piece[:, 1:] if time else piece for piece in pieces]
    return make_recording(path, rig, channels, values, rate=rate, rate_source=rate_source, form=FORM)


def _heading(path: Path, file: TextIO) -> str:
    heading = file.readline(LONGEST)
    if len(heading) == LONGEST:
        raise DataError(f"{path}, row 1: has more than {LONGEST} characters, want a CSV file with a heading")
    return heading


def _delimiter(heading: str) -> str:
    return max(",;\t", key=heading.count)


def _offers(heading: str, delimiter: str, mapping: ChannelMapping | None) -> list[FileChannel]:
    """Return the channel in each cell of the heading, in order; without a mapping only "name [unit]" has a name."""
    available = []
    for cell in (text.strip().strip('"').strip() for text in heading.split(delimiter)):
        name, _, rest = (part.strip() for part in cell.partition("["))
        unit = rest.removesuffix("]").strip()
        if name and unit and rest.endswith("]") and not set("[]") & set(name + unit):
            available.append(FileChannel((name, cell), unit))
        else:
            available.append(FileChannel((cell,) if mapping else ()))
    return available


def _time(path: Path, available: Sequence[FileChannel], mapping: ChannelMapping | None) -> Column | None:
    """Return the column of times; None where the mapping gives the rate instead."""
    asked = mapping.time if mapping else None
    if asked is None and mapping and mapping.rate:
        return None
    index = find_channel(path, available, "time", asked.column if asked else "time", form=FORM)
    if asked and asked.unit:
        return Column("time", index, asked.unit)
    unit = available[index].unit
    try:
        return Column("time", index, to_si(f"1 {unit}", "time"))
    except ValueError as error:
        raise DataError(f"{path}, row 1: column 'time' is in [{unit}], want a time such as s or ms") from error


def _pieces(path: Path, file: TextIO, delimiter: str, columns: Sequence[Column]) -> Iterator[NDArray[np.float64]]:
    """Yield the numbers (row, column) of some rows at a time, times in seconds."""
    row = FORM.first
    while lines := list(itertools.islice(file, PIECE)):
        filled = len(lines)
        while filled and not lines[filled - 1].strip():
            filled -= 1
        if filled < len(lines) and file.read().strip():  # blank lines may end a file, not part it
            raise DataError(f"{path}, row {row + filled}: is blank, want {len(columns)} numbers")
        lines = lines[:filled]
        if lines:
            with np.errstate(over="ignore"):  # of absurd times, see _sampling
                values = _numbers(path, lines, row, delimiter, columns) * [c.factor for c in columns]
            yield values
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
    """Return the error for the first cell that is not a number."""
    for number, line in enumerate(lines, start=row):
        cells = line.split(delimiter)
        if not line.strip():
            return f"{path}, row {number}: is blank, want {len(columns)} numbers"
        for column in columns:
            if column.index >= len(cells):
                return f"{path}, row {number}: ends before column '{column.name}', want a number there"
            cell = cells[column.index].strip()
            if not _is_number(cell):
                got = f"'{cell:.40}'" if cell else "an empty cell"
                return f"{path}, row {number}, column '{column.name}': got {got}, want a number such as -1.25"
    return f"{path}, rows {row} to {row + len(lines) - 1}: cannot be read, want one line per row"


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def _rate(
    path: Path, pieces: Sequence[NDArray[np.float64]], time: Column | None, mapping: ChannelMapping | None
) -> tuple[float, str]:
    """Return the sample rate [Hz] and where it comes from."""
    if time is None and mapping and mapping.rate:
        return mapping.rate, "as the mapping says"
    rate, start = _sampling(path, [piece[:, 0] for piece in pieces])
    if mapping and mapping.rate and abs(mapping.rate - rate) > 1e-3 * rate:
        raise DataError(
            f"{path}, column 'time': says {rate:.6g} Hz, the mapping {mapping.rate:.6g} Hz; want one left out"
        )
    return rate, f"from the time column, which began at {start:g} s"


def _sampling(path: Path, pieces: list[NDArray[np.float64]]) -> tuple[float, float]:
    """Return the sample rate [Hz] and the first time [s]; every step must be the same to within the printed digits."""
    times = np.concatenate(pieces) if pieces else np.empty(0)
    if len(times) < 3:
        raise DataError(f"{path}: has {len(times)} rows of numbers, want waveforms")
    with np.errstate(over="ignore", invalid="ignore"):  # of absurd times; they are found by their uneven steps
        steps = np.diff(times)
    step = float(np.median(steps))
    if not 0 < step < LONGEST_STEP:
        raise DataError(f"{path}, column 'time': does not rise from row to row, want times of evenly spaced samples")
    if len(uneven := np.flatnonzero(~(np.abs(steps - step) <= JITTER * step))):
        row = int(uneven[0]) + 3  # the heading is row 1, the first step leads to the second row of numbers
        raise DataError(
            f"{path}, row {row}, column 'time': is {float(steps[uneven[0]]) * 1e3:.6g} ms after the row before, "
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
