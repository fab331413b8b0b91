"""Table of critical speeds: amplification factor, damping ratio, half-power speeds, separation margin."""

from collections.abc import Sequence

from rotorrig.app.plot_data import CriticalSpeed
from rotorrig.app.report.html import paragraph, table
from rotorrig.app.text import NO_RESONANCE, critical_speed_cells, half_power_text, margin_text
from rotorrig.processing import SpeedWindow
from rotorrig.rig.config import RPM

_DEFINITIONS = (
    "Critical speed: where the 1X amplitude of the run peaks. AF, amplification factor: critical speed over the "
    "distance of the half-power speeds, at 0.707 of the peak; damping ratio ζ = 1 / (2 AF). All as API RP 684 defines "
    "them, on the curve as drawn: a run of changing speed shifts and flattens its peak. ± is the noise of the vectors "
    "alone; the model's values are read off its curve."
)


def critical_speeds_table(found: Sequence[CriticalSpeed], operating: SpeedWindow | None) -> str:
    """Return the table; with the separation margins where operating speeds are given."""
    if not found:
        return paragraph(NO_RESONANCE)
    modelled = any(each.model for each in found)
    header = ["probe, run", "critical speed, rpm", "AF", "ζ, %", "half-power speeds, rpm"]
    header += ["model, rpm", "AF", "ζ, %"] if modelled else []
    header += [_margin_heading(operating)] if operating else []
    rows = []
    for each in found:
        cells = [f"{each.probe}, {each.run}", *critical_speed_cells(each.measured), half_power_text(each.measured)]
        cells += critical_speed_cells(each.model) if modelled else []
        cells += [margin_text(each.measured, operating)] if operating else []
        rows.append(cells)
    return table("Critical speeds", header, rows) + paragraph(_DEFINITIONS)


def _margin_heading(operating: SpeedWindow) -> str:
    low, high = operating.low * RPM, operating.high * RPM
    return f"margin to {low:.0f} rpm" if low == high else f"margin to {low:.0f} to {high:.0f} rpm"
