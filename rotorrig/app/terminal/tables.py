"""Tables for the terminal: identified values beside nameplate and, where a simulated plant has one, the truth."""

import math
from collections.abc import Mapping

from rich import box
from rich.markup import escape
from rich.table import Table

from rotorrig.app.text import SHOWN, bearing_coefficients, change, interval
from rotorrig.app.text import causes as cause_text
from rotorrig.identify import Diagnosis, Estimate, Identification
from rotorrig.rig.config import RPM, RigConfig


def identified(found: Identification, truth: Mapping[str, float] | None = None) -> Table:
    """Return a table of every fit's values ± 1 sigma, beside the nameplate or, where it is known, truth and error."""
    beside = ", beside the plant's sealed truth" if truth else ""
    table = Table(title=f"Identified, ± 1 sigma, limits at 95 %{beside}", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    table.add_column("truth" if truth else "nameplate", justify="right", no_wrap=True)
    for fit in found.fits:
        band = f"{fit.band[0] * RPM:.0f}-{fit.band[1] * RPM:.0f} rpm"
        table.add_column(f"{fit.name}\n{band}", justify="right", no_wrap=True)
        if truth:
            table.add_column("off", justify="right", no_wrap=True)
    for first in found.fits[0].estimates:
        unit, factor = SHOWN.get(first.unit, (first.unit, 1.0))
        known = truth.get(first.name, math.nan) if truth else first.nameplate
        cells = [rf"{first.name} \[{unit}]", number(known * factor)]
        for fit in found.fits:
            estimate = fit.estimate(first.name)
            cells.append(value_with_sigma(estimate, factor))
            cells += [change(estimate, known)] if truth else []
        table.add_row(*cells)
    return table


def causes(found: Diagnosis) -> Table:
    """Return a table of the causes tried: what was found of each, and what speaks for it."""
    table = Table(title="Causes tried, best first", box=box.SIMPLE_HEAD, title_justify="left")
    for heading in ("cause", "size", "evidence", "held-out error", ""):
        table.add_column(heading, justify="right" if heading == "evidence" else "left")
    for cause in cause_text.listed(found):
        cells = (cause.label, cause_text.size(cause), cause_text.evidence(cause), cause_text.heldout(cause))
        table.add_row(*map(escape, cells), cause_text.standing(cause, found), style="bold" if cause.chosen else "")
    return table


def value_with_sigma(estimate: Estimate, factor: float) -> str:
    """Return "33.91 ± 0.12", with as many digits as the sigma warrants, and the 95 % interval where it says more."""
    within = interval(estimate, unit=False)
    if not estimate.determined or not math.isfinite(estimate.sigma):
        return f"({estimate.value * factor:.3g}) {within or 'undetermined'}"
    sigma = estimate.sigma * factor
    digits = max(0, 1 - math.floor(math.log10(sigma))) if sigma > 0 else 3
    known = f"{estimate.value * factor:.{digits}f} ± {sigma:.{digits}f}"
    return f"{known}\n{within}" if within and estimate.interval_by != "covariance" else known


def number(value: float) -> str:
    """Return four significant digits, or a dash for what is not known."""
    return "-" if math.isnan(value) else f"{value:.4g}"


def rig_parts(rig: RigConfig) -> Table:
    """Return what a config says, part by part, for `rotor check`."""
    table = Table(title=f"{rig.name} (config {rig.hash})")
    for column in ("part", "at, mm", "what"):
        table.add_column(column, justify="right" if column == "at, mm" else "left")
    for tube in rig.shaft.tubes:
        bore = f", bore {tube.inner_diameter * 1e3:g} mm" if tube.inner_diameter else ""
        table.add_row(
            "shaft",
            f"{tube.start * 1e3:g}-{tube.end * 1e3:g}",
            f"{tube.diameter * 1e3:g} mm{bore}, E {tube.youngs_modulus / 1e9:g} GPa, {tube.density:g} kg/m³",
        )
    for disk in rig.disks:
        table.add_row(f"disk {disk.name}", f"{disk.position * 1e3:g}", f"{disk.mass:g} kg")
    for b in rig.bearings:
        table.add_row(f"bearing {b.name}", f"{b.position * 1e3:g}", bearing_coefficients(b))
    for p in rig.probes:
        angle, gain = math.degrees(p.angle), p.sensitivity / 1e3
        table.add_row(f"probe {p.name}", f"{p.position * 1e3:g}", f"{angle:g} deg, channel {p.channel}, {gain:g} mV/um")
    if rig.keyphasor:
        table.add_row("keyphasor", "", f"channel {rig.keyphasor.channel}, {rig.keyphasor.edge} edge")
    for effect in rig.effects:
        values = ", ".join(f"{name} {value:.4g}" for name, value in effect.parameters.items())
        table.add_row("effect", "", escape(f"{effect.label}: {values} (SI)"))
    if rig.limits:
        limits = f"{rig.limits.overspeed * RPM:.0f} rpm, {rig.limits.vibration * 1e6:g} um 0-peak"
        table.add_row("limits", "", limits)
    return table
