"""The rig: side view to scale, end view and nameplate."""

import math

from rotorrig.app.report.drawings import end_view, side_view
from rotorrig.app.report.html import Section, details, paragraph, scrolling, section, table
from rotorrig.app.text import bearing_coefficients
from rotorrig.rig.config import RigConfig


def rig_section(config: RigConfig) -> Section:
    """Return the drawings and the nameplate of a rig."""
    drawn = scrolling("Side view", side_view(config))
    side = f'<figure class="wide">{drawn}<figcaption>Side view, to scale</figcaption></figure>'
    end = f'<figure class="end">{end_view(config)}<figcaption>End view, axes and probes</figcaption></figure>'
    drawing = f'<div class="rig">{side}{end}</div>'
    return section("rig", "The rig", paragraph(config.notes), drawing, _nameplate(config))


def _nameplate(config: RigConfig) -> str:
    """Return disks, bearings and probes of the config."""
    rows = [
        [
            f"disk {d.name}",
            f"{d.position * 1e3:g}",
            f"{d.mass:.4g} kg, Ip {d.polar_inertia:.4g}, It {d.transverse_inertia:.4g} kg m²",
        ]
        for d in config.disks
    ]
    rows += [[f"bearing {b.name}", f"{b.position * 1e3:g}", bearing_coefficients(b)] for b in config.bearings]
    rows += [
        [f"probe {p.name}", f"{p.position * 1e3:g}", f"at {math.degrees(p.angle):g}°, {p.sensitivity / 1e3:.4g} mV/µm"]
        for p in config.probes
    ]
    return details("Nameplate values", table("Nameplate", ["part", "mm from the coupling", "values"], rows))
