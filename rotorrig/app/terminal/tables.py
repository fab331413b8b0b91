"""Terminal tables: identified values beside nameplate or truth, causes tried."""

import math
from collections.abc import Mapping

from rich import box
from rich.table import Table

from rotorrig.app.plot_data import critical_speeds, fits_of
from rotorrig.app.text import (
    CAUSES_TITLE,
    NO_RESONANCE,
    SHOWN,
    cause_evidence,
    cause_prediction_error,
    cause_size,
    cause_status,
    causes_to_list,
    change_text,
    critical_speed_cells,
    interval_text,
    pull_rows,
)
from rotorrig.identify import Diagnosis, Estimate, Fit, Identification, NameplateCheck
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM

MINIMA = 4  # columns that fit a terminal


def identification_table(identification: Identification, truth: Mapping[str, float] | None = None) -> Table:
    """Return every fit's values ± 1 sigma, beside the nameplate or, if it is known, truth and error."""
    beside = ", against the simulated rig's truth" if truth else ""
    table = Table(title=f"Identified, ± 1 sigma, limits at 95 %{beside}", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    table.add_column("truth" if truth else "nameplate", justify="right", no_wrap=True)
    for fit in identification.fits:
        band = f"{fit.band[0] * RPM:.0f}-{fit.band[1] * RPM:.0f} rpm"
        table.add_column(f"{fit.name}\n{band}", justify="right", no_wrap=True)
        if truth:
            table.add_column("error", justify="right", no_wrap=True)
    for first in identification.fits[0].estimates:
        unit, factor = SHOWN.get(first.unit, (first.unit, 1.0))
        known = truth.get(first.name, math.nan) if truth else first.nameplate
        cells = [f"{first.name} [{unit}]", number(known * factor)]
        for fit in identification.fits:
            estimate = fit.estimate(first.name)
            cells.append(estimate_cell(estimate, factor))
            cells += [change_text(estimate, known)] if truth else []
        table.add_row(*cells)
    return table


def search_table(fit: Fit) -> Table:
    """Return the best minima of the objective that was searched, and the refined values beside them."""
    minima = fit.optima[:MINIMA]
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("", no_wrap=True)
    for i in range(len(minima)):
        table.add_column(f"minimum {i + 1}" if len(minima) > 1 else "minimum", justify="right")
    table.add_column("refined", justify="right")
    table.add_row(fit.objective, *(f"{optimum.cost:.5g}" for optimum in minima), "")
    for i, name in enumerate(fit.unknowns):
        unit, factor = SHOWN.get(fit.estimate(name).unit, (fit.estimate(name).unit, 1.0))
        cells = [f"{optimum.theta[i] * factor:.5g}" for optimum in minima]
        table.add_row(f"{name} [{unit}]", *cells, f"{fit.estimate(name).value * factor:.5g}")
    return table


def critical_speeds_table(response: OrderTrackedResponse, identification: Identification) -> Table | str:
    """Return the critical speeds of a response, measured and below by the fit's model; a sentence where none is."""
    fit = fits_of(identification, response).fits[0]
    found = critical_speeds(response, fit.prediction, fit.resonances)
    if not found:
        return NO_RESONANCE
    table = Table(
        title="Critical speeds, ± 1 sigma; AF: amplification factor", box=box.SIMPLE_HEAD, title_justify="left"
    )
    for heading in ("", "rpm", "AF", "damping ratio, %"):
        table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for each in found:
        table.add_row(f"{each.probe} {each.run}", *critical_speed_cells(each.measured))
        if each.model:
            table.add_row("  model", *critical_speed_cells(each.model), style="dim")
    return table


def causes_table(diagnosis: Diagnosis) -> Table:
    """Return a table of the causes tried: size, evidence, cross-validation and status."""
    table = Table(title=CAUSES_TITLE, box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("cause", "size", "evidence", "error on unseen\ndata, µm 0-peak", ""):
        table.add_column(heading, justify="right" if heading == "evidence" else "left")
    for cause in causes_to_list(diagnosis):
        cells = (cause.label, cause_size(cause), cause_evidence(cause), cause_prediction_error(cause))
        table.add_row(*cells, cause_status(cause, diagnosis), style="bold" if cause.chosen else "")
    return table


def nameplate_table(check: NameplateCheck) -> Table | None:
    """Return a table of what the fit pulls at in the config; None where it pulls at nothing."""
    rows = list(pull_rows(check))
    if not rows:
        return None
    table = Table(title="Pulled in the config, by group", box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("pulled most", "config", "by the data alone", "group's pull"):
        table.add_column(heading)
    for row in rows:
        table.add_row(*row)
    return table


def estimate_cell(estimate: Estimate, factor: float) -> str:
    """Return "33.91 ± 0.12", with as many digits as the sigma warrants, and the 95 % interval where it says more."""
    within = interval_text(estimate, unit=False)
    if not estimate.determined or not math.isfinite(estimate.sigma):
        return f"({estimate.value * factor:.3g}) {within or 'undetermined'}"
    sigma = estimate.sigma * factor
    digits = max(0, 1 - math.floor(math.log10(sigma))) if sigma > 0 else 3
    known = f"{estimate.value * factor:.{digits}f} ± {sigma:.{digits}f}"
    return f"{known}\n{within}" if within and estimate.interval_by != "covariance" else known


def number(value: float) -> str:
    """Return four significant digits, or a dash for what is not known."""
    return "-" if math.isnan(value) else f"{value:.4g}"
