"""The files of curves beside a page, one for each run with a response: missing ones are made, others stay, old ones go.

Reading a response takes 50 ms; many are read in several processes.
"""

import multiprocessing
import os
import re
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from rotorrig.app.lab.page.bode_data import is_written, write_bode_data
from rotorrig.app.lab.page.catalogue import Row
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError

CURVES = "bode"  # folder beside the page
FEW = 50  # files, for which starting processes would take longer than it saves
_HASH = re.compile(r"[0-9a-f]{16}")
_FILE = re.compile(r"[0-9a-f]{16}-[0-9a-f]{16}\.js")


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveFile:
    """A file of curves and what it is made from."""

    path: Path
    run_id: str
    response: Path

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
    for done, (file, fault) in enumerate(_write_all(missing), start=1):
        progress(done / len(missing))
        if fault:
            faults[file] = fault
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
    path = folder / CURVES / f"{run['run_id']}-{run['key']}.js"
    return CurveFile(path=path, run_id=run["run_id"], response=lab / run["response_file"])


def _write_all(files: Sequence[CurveFile]) -> Iterator[tuple[CurveFile, str]]:
    """Write files and yield each as it is done, with why it could not be made; Ctrl-C reaches this process alone."""
    if len(files) <= FEW:
        yield from ((file, _write(file)) for file in files)
        return
    pool = ProcessPoolExecutor(
        os.cpu_count(),
        mp_context=multiprocessing.get_context("spawn"),  # a fork would copy locks that threads of this process hold
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    try:
        by_future = {pool.submit(_write, file): file for file in files}
        for future in as_completed(by_future):
            yield by_future[future], future.result()
    except BrokenProcessPool as error:
        raise DataError("a process that read responses ended by itself: killed, or out of memory; try again") from error
    finally:
        pool.shutdown(cancel_futures=True)


def _write(file: CurveFile) -> str:
    """Write the curves of a run; return why its response has none, else nothing."""
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
