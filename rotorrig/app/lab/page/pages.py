"""The folder of pages: index.html with all runs in it, its scripts, plotly.js, and a file of curves for each run."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from html import escape
from pathlib import Path
from string import Template
from urllib.parse import quote

from plotly.offline import get_plotlyjs

from rotorrig.app.lab.page.bode_data import as_script
from rotorrig.app.lab.page.catalogue import Catalogue, Row, read_catalogue
from rotorrig.app.lab.page.curve_files import CURVES, write_curve_files
from rotorrig.app.lab.page.runs import row_of_run
from rotorrig.app.lab.page.trends import collect_trends
from rotorrig.app.report import read_asset
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError, write_whole_text
from rotorrig.rig.config import Limits

INDEX, PLOTLY = "index.html", "plotly.min.js"
SCRIPTS = ("unit-choice.js", "lab.js", "lab-plots.js")
MARK = '<meta name="generator" content="rotor lab page">'  # of an index that may be replaced


@dataclass(frozen=True, slots=True, kw_only=True)
class LabPage:
    """What was written."""

    index: Path
    runs: int
    curves: int  # runs with a Bode plot
    unread: tuple[str, ...]  # sentences on responses that could not be read; their runs have none


def check_page_folder(folder: Path, *, force: bool = False) -> None:
    """Raise DataError unless pages may be written into a folder: a new one, an empty one or that of earlier pages.

    With `force` other files may be there, and stay; an index.html that is no such page is never replaced.
    """
    index = folder / INDEX
    try:
        if not folder.exists():
            return
        if not folder.is_dir():
            raise DataError(f"{folder}: is a file, want a folder for the pages")
        if index.exists() and MARK.encode() in index.read_bytes()[:2000]:
            return
        if index.exists():
            raise DataError(f"{index}: is no page of a lab, want another folder for the pages")
        if not force and any(folder.iterdir()):
            raise DataError(f"{folder}: has other files, want another folder, or --force to write the pages among them")
    except OSError as error:
        raise DataError(f"{folder}: cannot be read ({error.strerror})") from error


def write_lab_page(
    lab: Path,
    folder: Path,
    *,
    force: bool = False,
    units: str = "",
    progress: Callable[[float], None] = lambda _: None,
) -> LabPage:
    """Write the pages of a lab into a folder, the index last; `progress` is told the share of the curves done.

    `units`, of AMPLITUDE_UNITS, are those in which amplitudes are told until the reader chooses others. Raises
    DataError if there is no catalogue, or the folder holds something else (see `check_page_folder`).
    """
    check_page_folder(folder, force=force)
    catalogue = read_catalogue(lab)
    try:
        (folder / CURVES).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DataError(f"{folder}: cannot be written ({error.strerror})") from error
    addresses, unread = write_curve_files(lab, folder, catalogue.runs, progress=progress)
    rows = [
        row_of_run(catalogue, run, report=_address_of_report(lab, folder, run), bode=addresses.get(run["run_id"]))
        for run in catalogue.runs
    ]
    trends = collect_trends(catalogue, _limits_of_rigs(lab, catalogue))
    for name in SCRIPTS:
        _write_once(folder / name, read_asset(name))
    _write_once(folder / PLOTLY, get_plotlyjs())
    table = {"runs": rows, "trends": [{name: getattr(t, name) for name in t.__slots__} for t in trends]}
    write_whole_text(folder / INDEX, _index(lab, table, units))
    return LabPage(index=folder / INDEX, runs=len(rows), curves=len(addresses), unread=tuple(unread))


def _address_of_report(lab: Path, folder: Path, run: Row) -> str | None:
    """Return where a run's report is as seen from the pages, as an address; None if there is none."""
    if run["report_file"] is None or not (report := lab / run["report_file"]).is_file():
        return None
    return quote(Path(os.path.relpath(report, folder)).as_posix())


def _limits_of_rigs(lab: Path, catalogue: Catalogue) -> Mapping[str, Limits]:
    """Return the limits of the rigs whose newest response has some in its config."""
    newest = {run["rig"]: lab / run["response_file"] for run in catalogue.runs if run["response_file"]}
    limits = {}
    for rig, path in newest.items():
        try:
            its = read_response(path).rig.limits if path.is_file() else None
        except DataError:
            continue  # told of already
        if its is not None:
            limits[rig] = its
    return limits


def _write_once(path: Path, text: str) -> None:
    """Write a file unless it is there as it should be."""
    if not path.is_file() or path.read_bytes() != text.encode():
        write_whole_text(path, text)


def _index(lab: Path, table: object, units: str) -> str:
    name = lab.resolve().name or "lab"
    return Template(read_asset("lab.html")).substitute(
        mark=MARK,
        title=escape(f"{name}: runs of the lab"),
        heading=escape(name),
        written=f"{datetime.now().astimezone():%Y-%m-%d %H:%M %Z}",
        style=read_asset("report.css") + read_asset("lab.css"),
        units=escape(units),
        runs=as_script(table),
    )
