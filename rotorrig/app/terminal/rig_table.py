"""The parts of a config as a table in the terminal."""

import math

from rich.table import Table

from rotorrig.app.text import bearing_coefficients
from rotorrig.rig.config import RPM, RigConfig


def rig_table(rig: RigConfig) -> Table:
    """Return the parts of a config as a table, for `rotor check`."""
    table = Table(title=f"{rig.name} (config {rig.hash})")
    for column in ("part", "at, mm", "values"):
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
        table.add_row("effect", "", f"{effect.label}: {values} (SI)")
    if rig.limits:
        limits = f"{rig.limits.overspeed * RPM:.0f} rpm, {rig.limits.vibration * 1e6:g} um 0-peak"
        table.add_row("limits", "", limits)
    return table
