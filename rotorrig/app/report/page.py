"""The report page: verdict, plots and values on the first screen, then the evidence."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from rotorrig.acquisition import WaveformSource
from rotorrig.app.plot_data import check_balance_of, check_run_of, fits_of, part_of
from rotorrig.app.report.first_screen import first_screen
from rotorrig.app.report.frame import write_page
from rotorrig.app.report.html import Section
from rotorrig.app.report.sections import (
    balance_section,
    banner,
    cascade_section,
    causes_section,
    centreline_section,
    conventions_section,
    full_spectrum_section,
    identified_section,
    investigation_section,
    missing_section,
    nameplate_section,
    orbits_section,
    other_orders_section,
    provenance_section,
    residuals_section,
    rig_section,
    synchronous_section,
    time_base_section,
    tracking_section,
    undetectable_section,
)
from rotorrig.balancing import Balance
from rotorrig.identify import Diagnosis, Identification
from rotorrig.investigation import Journal
from rotorrig.processing import OrderTrackedResponse, SpeedWindow, Waveforms


def write_report(
    path: Path,
    *,
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    truth: Mapping[str, float] | None = None,
    journal: Journal | None = None,
    balance: Balance | None = None,
    operating: SpeedWindow | None = None,
    recording: WaveformSource | None = None,
    units: str = "",
) -> None:
    """Write the report of a response, with what is given: fit, diagnosis, investigation that led to it, balance, run.

    `truth` maps names of estimates to the simulated rig's own values in SI, for a column beside the estimates;
    `operating` are the speeds whose margins to the critical speeds are told, `units` those of AMPLITUDE_UNITS in which
    amplitudes are until the reader chooses others.
    Raises DataError if fit, diagnosis, balance or recording belong to another run, or the file cannot be written.
    """
    identification = fits_of(identification, response) if identification else None
    diagnosis = part_of(diagnosis, response) if diagnosis else None
    if balance:
        check_balance_of(balance, response)
    if recording:
        check_run_of(recording, response)
    waveforms = Waveforms(recording) if recording else None
    verdict = banner(identification, diagnosis, amplitudes_alone=response.amplitudes_alone)
    parts = (
        investigation_section(journal),
        missing_section(diagnosis, response.rig),
        residuals_section(response, diagnosis),
        synchronous_section(response, identification, diagnosis, operating=operating),
        causes_section(diagnosis),
        nameplate_section(identification, diagnosis),
        identified_section(identification, diagnosis, truth=truth),
        balance_section(balance, response.rig),
        cascade_section(response, waveforms),
        full_spectrum_section(response),
        other_orders_section(response),
        orbits_section(response),
        time_base_section(response, waveforms),
        centreline_section(response),
        undetectable_section(identification, diagnosis),
        tracking_section(response),
        rig_section(response.rig),
        provenance_section(response, identification, diagnosis),
        conventions_section(response),
    )
    write_page(
        path,
        kind="Rotor report",
        heading=response.rig.name,
        source=response.source.source,
        body=_body((verdict, first_screen(response, identification, diagnosis)), [part for part in parts if part]),
        units=units,
        unscripted="All text, tables and drawings are here; “values” expands the data of a Bode plot.",
        conventions='Amplitudes are 0-peak, phases lag, ± is one standard deviation: see <a href="#conventions">'
        "Conventions</a>.",
    )


def _body(first: Sequence[Section], sections: Sequence[Section]) -> str:
    links = "".join(f'<li><a href="#{part.name}">{escape(part.heading)}</a></li>' for part in sections)
    contents = f'<nav class="contents" aria-label="Contents"><ul>{links}</ul></nav>'
    return "\n".join([*(part.html for part in first), contents, *(part.html for part in sections)])
