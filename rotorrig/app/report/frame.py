"""The frame of a page: one self-contained HTML file with its style, its script and its plots inside.

Nothing is fetched, and headings are escaped here; what comes as HTML has to be escaped already.
"""

import base64
import gzip
from datetime import datetime
from functools import cache
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

from plotly.offline import get_plotlyjs

from rotorrig.rig import write_whole_text


def write_page(
    path: Path,
    *,
    kind: str,
    heading: str,
    source: str,
    body: str,
    conventions: str,
    unscripted: str = "All text, tables and drawings are here.",
    look: str = "",
    units: str = "",
) -> None:
    """Write a page of a kind, "Rotor report", about a rig and the recording `source`; "": a live rig.

    `body` and `conventions` are HTML, `look` a class of report.css; `units`, of AMPLITUDE_UNITS, are those in which
    amplitudes are told until the reader chooses others. Raises DataError if it cannot be written.
    """
    page = Template(read_asset("report.html")).substitute(
        title=escape(f"{heading}: {kind[0].lower()}{kind[1:]}"),
        kind=escape(kind),
        heading=escape(heading),
        source=escape(source or "live rig"),
        written=f"{datetime.now().astimezone():%Y-%m-%d %H:%M %Z}",
        look=look,
        style=read_asset("report.css"),
        plotly=_pack_plotly(),
        switch=read_asset("unit-choice.js") + read_asset("units.js"),
        script=read_asset("report.js"),
        units=escape(units),
        body=body,
        conventions=conventions,
        unscripted=escape(unscripted),
    )
    write_whole_text(path, page)


def read_asset(name: str) -> str:
    """Return the text of a file of app/assets."""
    return resources.files("rotorrig.app").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _pack_plotly() -> str:
    """Return plotly.js as gzip in base64, 2 MB instead of 4.8; report.js unpacks it."""
    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), mtime=0)).decode()
