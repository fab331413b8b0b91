"""Tables for the terminal: identified values beside nameplate and, where a simulated plant has one, the truth."""

import math
from collections.abc import Mapping

from rich.table import Table

from rotorrig.acquisition.plans import RPM
from rotorrig.identify.identification import Estimate, Identification
from rotorrig.rig.description import RigConfig

#: name -> (factor from SI, unit for people)
SHOWN = {
    "kxx": (1e-3, "kN/m"),
    "kyy": (1e-3, "kN/m"),
    "cxx": (1.0, "N s/m"),
    "cyy": (1.0, "N s/m"),
    "u": (1e6, "g mm"),
    "phase": (180 / math.pi, "deg"),
}


def identified(found: Identification, truth: Mapping[str, float] | None = None) -> Table:
    """Return a table of every fit's values and 1-sigma uncertainties; errors in % and sigmas where truth is known."""
    table = Table(title="Identified, ± 1 sigma" + (", beside the plant's sealed truth" if truth else ""))
    table.add_column("")
    table.add_column("nameplate", justify="right")
    for fit in found.fits:
        table.add_column(f"{fit.name}\n{fit.band[0] * RPM:.0f}-{fit.band[1] * RPM:.0f} rpm", justify="right")
        if truth:
            table.add_column("error", justify="right")
    if truth:
        table.add_column("truth", justify="right")
    for name, (factor, unit) in SHOWN.items():
        cells = [f"{name} [{unit}]".replace("[", r"\["), number(found.fits[0].estimate(name).nameplate * factor)]
        for fit in found.fits:
            estimate = fit.estimate(name)
            cells.append(value_with_sigma(estimate, factor))
            if truth:
                cells.append(error(estimate, truth[name], factor))
        if truth:
            cells.append(number(truth[name] * factor))
        table.add_row(*cells)
    return table


def value_with_sigma(estimate: Estimate, factor: float) -> str:
    """Return "33.91 ± 0.12", with as many digits as the sigma warrants."""
    if not estimate.determined or not math.isfinite(estimate.sigma):
        return f"({estimate.value * factor:.3g}) not determined"
    sigma = estimate.sigma * factor
    digits = max(0, 1 - math.floor(math.log10(sigma))) if sigma > 0 else 3
    return f"{estimate.value * factor:.{digits}f} ± {sigma:.{digits}f}"


def error(estimate: Estimate, truth: float, factor: float) -> str:
    """Return "+0.4 %, 0.7 sigma"; an angle's error in degrees."""
    difference = estimate.value - truth
    if estimate.name == "phase":
        difference = math.remainder(difference, 2 * math.pi)
        size = f"{difference * factor:+.2f} deg"
    else:
        size = f"{difference / truth:+.2%}".replace("%", " %")
    if not estimate.determined or not math.isfinite(estimate.sigma):
        return size
    return f"{size}, {abs(difference) / estimate.sigma:.1f} sigma"


def number(value: float) -> str:
    """Return four significant digits, or a dash for what is not known."""
    return "-" if math.isnan(value) else f"{value:.4g}"


def rig_parts(rig: RigConfig) -> Table:
    """Return what a config says, part by part, for `rotor check`."""
    table = Table(title=f"{rig.name} (config {rig.hash})")
    for column in ("part", "at [mm]", "what"):
        table.add_column(column, justify="right" if column == "at [mm]" else "left")
    shaft = rig.shaft
    table.add_row(
        "shaft",
        f"0-{shaft.length * 1e3:g}",
        f"{shaft.diameter * 1e3:g} mm, E {shaft.youngs_modulus / 1e9:g} GPa, {shaft.density:g} kg/m³",
    )
    for disk in rig.disks:
        table.add_row(f"disk {disk.name}", f"{disk.position * 1e3:g}", f"{disk.mass:g} kg")
    for b in rig.bearings:
        stiffness = f"k {b.kxx / 1e3:g}, {b.kyy / 1e3:g} kN/m, c {b.cxx:g}, {b.cyy:g} N s/m (x, y)"
        table.add_row(f"bearing {b.name}", f"{b.position * 1e3:g}", stiffness)
    for p in rig.probes:
        angle, gain = math.degrees(p.angle), p.sensitivity / 1e3
        table.add_row(f"probe {p.name}", f"{p.position * 1e3:g}", f"{angle:g} deg, channel {p.channel}, {gain:g} mV/um")
    if rig.keyphasor:
        table.add_row("keyphasor", "", f"channel {rig.keyphasor.channel}, {rig.keyphasor.edge} edge")
    if rig.limits:
        limits = f"{rig.limits.overspeed * RPM:.0f} rpm, {rig.limits.vibration * 1e6:g} um 0-peak"
        table.add_row("limits", "", limits)
    return table
