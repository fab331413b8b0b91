"""The report page: one self-contained HTML file, verdict first, then the evidence.

Plots are inside the file, nothing is fetched, and all text is escaped.
"""

import base64
import gzip
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

from plotly.offline import get_plotlyjs

from rotorrig.app.plot_data import fits_of, part_of
from rotorrig.app.report.html import Section
from rotorrig.app.report.sections import (
    banner,
    causes_section,
    centreline_section,
    conventions_section,
    full_spectrum_section,
    identified_section,
    investigation_section,
    nameplate_section,
    orbits_section,
    other_orders_section,
    provenance_section,
    residuals_section,
    rig_section,
    synchronous_section,
    tracking_section,
    undetectable_section,
)
from rotorrig.identify import Diagnosis, Identification
from rotorrig.investigation import Journal
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import write_whole_text


def write_report(
    path: Path,
    *,
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    truth: Mapping[str, float] | None = None,
    journal: Journal | None = None,
) -> None:
    """Write the report of a response, with its fit and diagnosis if given, and the investigation that led to it.

    `truth` maps names of estimates to the simulated rig's own values in SI, for a column beside the estimates.
    Raises DataError if fit or diagnosis belong to another run, or the file cannot be written.
    """
    identification = fits_of(identification, response) if identification else None
    diagnosis = part_of(diagnosis, response) if diagnosis else None
    verdict = banner(identification, diagnosis)
    parts = (
        investigation_section(journal),
        residuals_section(response, diagnosis),
        synchronous_section(response, identification, diagnosis),
        causes_section(diagnosis),
        nameplate_section(identification, diagnosis),
        identified_section(identification, diagnosis, truth=truth),
        full_spectrum_section(response),
        other_orders_section(response),
        orbits_section(response),
        centreline_section(response),
        undetectable_section(identification, diagnosis),
        tracking_section(response),
        rig_section(response.rig),
        provenance_section(response, identification, diagnosis),
        conventions_section(response),
    )
    write_whole_text(path, _page(response, verdict, [part for part in parts if part]))


def _page(response: OrderTrackedResponse, verdict: Section, sections: Sequence[Section]) -> str:
    links = "".join(f'<li><a href="#{part.name}">{escape(part.heading)}</a></li>' for part in sections)
    return Template(_asset("report.html")).substitute(
        title=escape(f"{response.rig.name}: rotor report"),
        heading=escape(response.rig.name),
        source=escape(response.source.source or "live rig"),
        contents=links,
        style=_asset("report.css"),
        plotly=_pack_plotly(),
        script=_asset("report.js"),
        verdict=verdict.html,
        body="\n".join(part.html for part in sections),
        written=f"{datetime.now().astimezone():%Y-%m-%d %H:%M %Z}",
    )


def _asset(name: str) -> str:
    return resources.files("rotorrig.app").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _pack_plotly() -> str:
    """Return plotly.js as gzip in base64, 2 MB instead of 4.8; report.js unpacks it."""
    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), mtime=0)).decode()
