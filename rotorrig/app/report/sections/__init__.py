"""Sections of the report page, a file each: what there is nothing to show of is left out."""

from rotorrig.app.report.sections.balance import (
    KEY,
    amplitude_plot,
    balance_section,
    compared,
    corrections,
    highest_table,
    mounting,
    planes_drawn,
    polar_plot,
    vibration,
)
from rotorrig.app.report.sections.causes import causes_section, nameplate_section, undetectable_section
from rotorrig.app.report.sections.identified import identified_section
from rotorrig.app.report.sections.investigation import investigation_section
from rotorrig.app.report.sections.missing import missing_section
from rotorrig.app.report.sections.motion import centreline_section, orbits_section
from rotorrig.app.report.sections.orders import full_spectrum_section, other_orders_section
from rotorrig.app.report.sections.recording import cascade_section, time_base_section
from rotorrig.app.report.sections.residuals import residuals_section
from rotorrig.app.report.sections.rig import rig_section
from rotorrig.app.report.sections.source import conventions_section, provenance_section
from rotorrig.app.report.sections.synchronous import synchronous_section
from rotorrig.app.report.sections.tracking import tracking_section
from rotorrig.app.report.sections.verdict import banner

__all__ = [
    "KEY",
    "amplitude_plot",
    "balance_section",
    "banner",
    "cascade_section",
    "causes_section",
    "centreline_section",
    "compared",
    "conventions_section",
    "corrections",
    "full_spectrum_section",
    "highest_table",
    "identified_section",
    "investigation_section",
    "missing_section",
    "mounting",
    "nameplate_section",
    "orbits_section",
    "other_orders_section",
    "planes_drawn",
    "polar_plot",
    "provenance_section",
    "residuals_section",
    "rig_section",
    "synchronous_section",
    "time_base_section",
    "tracking_section",
    "undetectable_section",
    "vibration",
]
