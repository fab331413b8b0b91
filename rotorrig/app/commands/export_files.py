"""`rotor export`: our files for programs that read CSV or universal files, and a layout for Foxglove."""

from pathlib import Path

from rotorrig.acquisition.files import read_file_kind
from rotorrig.rig import DataError

LAYOUT = ".json"


def write_out(file: Path, out: Path) -> str:
    """Write a run's waveforms or a response's vectors to `out`, a .csv or .uff, and say what. Raises DataError.

    A .json is the layout that shows the response in Foxglove.
    """
    if out.suffix.lower() not in (".csv", ".uff", ".unv", LAYOUT):
        want = f"a name that ends in .csv or .uff, or {LAYOUT} for Foxglove"
        raise DataError(f"{out}: ends in '{out.suffix}', want {want}")
    if out.exists() and file.exists() and out.samefile(file):
        raise DataError(f"{out}: would be written over the file to export, want another name")
    write = _response if read_file_kind(file) == "response" else _run
    if write is _run and out.suffix.lower() == LAYOUT:
        raise DataError(f"{out}: a layout is made for a response.mcap, {file} is a run")
    return f"{out}: {write(file, out)}"


def _response(file: Path, out: Path) -> str:
    from rotorrig.app.commands.foxglove_layout import write_foxglove_layout
    from rotorrig.processing.files import read_response, response_csv, response_uff

    response = read_response(file)
    if out.suffix.lower() == LAYOUT:
        return f"{write_foxglove_layout(out, response)} panels for Foxglove: Import from file, in its layout menu"
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
    return made + (f", with {gaps} gap{'s' * (gaps > 1)}: the times jump there" if gaps else "")
