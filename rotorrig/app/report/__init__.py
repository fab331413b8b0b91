"""The HTML report: one file a section, figures by Plotly, drawings as SVG; one self-contained page to send."""

from rotorrig.app.report.page import write_report

__all__ = [
    "write_report",
]
