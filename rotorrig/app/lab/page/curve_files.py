"""The files of curves beside a page, one for each run with a response: missing ones are made, others stay, old ones go.

They are copies of what the lab kept when it tracked the run. Where it kept none, as versions before did, the response
is read, which takes 50 ms.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rotorrig.app.lab.page.bode_data import is_written, write_bode_data
from rotorrig.app.lab.page.catalogue import Row
from rotorrig.app.lab.storage import Lab
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError, write_whole_text

CURVES = "bode"  # folder beside the page
_HASH = re.compile(r"[0-9a-f]{16}")
_FILE = re.compile(r"[0-9a-f]{16}-[0-9a-f]{16}\.js")


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveFile:
    """A file of curves and what it is made from."""

    path: Path
    run_id: str
    response: Path
    kept: Path  # its curves as the lab wrote them, if it did

    @property
    def address(self) -> str:
        """Its address as seen from the page."""
        return f"{CURVES}/{self.path.name}"


def write_curve_files(
    lab: Path, folder: Path, runs: Sequence[Row], *, progress: Callable[[float], None]
) -> tuple[dict[str, str], list[str]]:
    """Write the curves of runs into a folder of pages; return their addresses by run_id, and why others have none.

    `progress` is told the share of the files done. Raises DataError if they cannot be written.
    """
    wanted = [file for run in runs if (file := _file_of(lab, folder, run))]
    missing = [file for file in wanted if not is_written(file.path)]
    faults: dict[CurveFile, str] = {}
    for done, file in enumerate(missing, start=1):
        if fault := _write(file):
            faults[file] = fault
        progress(done / len(missing))
    addresses = {file.run_id: file.address for file in wanted if file not in faults}
    _remove_others(folder / CURVES, {file.path.name for file in wanted})
    return addresses, [faults[file] for file in missing if file in faults]


def _file_of(lab: Path, folder: Path, run: Row) -> CurveFile | None:
    """Return the file of a run's curves; None if the run has no response."""
    if run["response_file"] is None or not (lab / run["response_file"]).is_file():
        return None
    for name in ("run_id", "key"):
        if not _HASH.fullmatch(run[name]):
            raise DataError(f"{lab}: its catalogue has {name} {run[name]!r}, want 16 hexadecimal digits")
    run_id, key = run["run_id"], run["key"]
    return CurveFile(
        path=folder / CURVES / f"{run_id}-{key}.js",
        run_id=run_id,
        response=lab / run["response_file"],
        kept=Lab(lab).curves(run_id, key),
    )


def _write(file: CurveFile) -> str:
    """Write the curves of a run; return why its response has none, else nothing. Raises DataError."""
    if is_written(file.kept):
        write_whole_text(file.path, file.kept.read_text(encoding="utf-8"))
        return ""
    try:
        response = read_response(file.response)
    except DataError as error:
        return str(error)
    if 1.0 not in response.orders:
        return f"{file.response}: has no 1X, want it for a Bode plot"
    write_bode_data(file.path, file.run_id, response)
    return ""


def _remove_others(folder: Path, kept: set[str]) -> None:
    """Remove curves of runs that are no longer in the catalogue, or were made anew. Raises DataError."""
    try:
        for path in folder.iterdir():
            if _FILE.fullmatch(path.name) and path.name not in kept:
                path.unlink()
    except OSError as error:
        raise DataError(f"{folder}: cannot be cleared of old curves ({error.strerror})") from error
