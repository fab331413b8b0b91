"""`rotor export`: runs and responses to CSV or UFF, responses to a Foxglove layout."""

from pathlib import Path

from rotorrig.acquisition.files import read_file_kind
from rotorrig.rig import DataError

LAYOUT = ".json"
_KINDS = {".csv": "csv", ".uff": "uff", ".unv": "uff", LAYOUT: "layout"}


def kind_made(out: Path) -> str:
    """Return the kind of file that an export of this name is. Raises DataError for another ending."""
    if out.suffix.lower() not in _KINDS:
        want = f"a name that ends in .csv or .uff, or {LAYOUT} for Foxglove"
        raise DataError(f"{out}: ends in '{out.suffix}', want {want}")
    return _KINDS[out.suffix.lower()]


def write_out(file: Path, out: Path) -> str:
    """Write a run's waveforms or a response's vectors to `out`, a .csv or .uff, and return a summary. Raises DataError.

    A .json is a Foxglove layout for the response.
    """
    kind = kind_made(out)
    write = _response if read_file_kind(file) == "response" else _run
    if write is _run and kind == "layout":
        raise DataError(f"{out}: a layout needs a response.mcap, {file} is a run")
    return f"{out}: {write(file, out)}"


def _response(file: Path, out: Path) -> str:
    from rotorrig.app.commands.other_programs import write_foxglove_layout
    from rotorrig.processing.files import read_response, response_csv, response_uff

    response = read_response(file)
    if out.suffix.lower() == LAYOUT:
        return f"{write_foxglove_layout(out, response)} panels for Foxglove: layout menu, Import from file"
    if out.suffix.lower() == ".csv":
        return f"{response_csv.write_csv(out, response)} rows"
    return f"{response_uff.write_uff(out, response)} order functions"


def _run(file: Path, out: Path) -> str:
    from rotorrig.acquisition.exporters import write_csv, write_uff
    from rotorrig.acquisition.files import read_recording

    recording = read_recording(file)
    made = (
        f"{write_csv(out, recording)} rows of volts"
        if out.suffix.lower() == ".csv"
        else f"{write_uff(out, recording)} time responses in volts"
    )
    gaps = len(recording.segments()) - 1
    return made + (f", with {gaps} gap{'s' * (gaps > 1)}" if gaps else "")
