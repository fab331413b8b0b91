"""HTML report, one self-contained page: one file per section, figures by Plotly, drawings as SVG."""

from rotorrig.app.report.page import write_report

__all__ = [
    "write_report",
]
