"""HTML pages, each self-contained - report, balance sheet, prediction - of sections, a file each.

Figures are by Plotly, drawings SVG.
"""

from rotorrig.app.report.balance_sheet import write_balance_sheet
from rotorrig.app.report.frame import read_asset
from rotorrig.app.report.page import write_report
from rotorrig.app.report.prediction_page import write_prediction_page

__all__ = [
    "read_asset",
    "write_balance_sheet",
    "write_prediction_page",
    "write_report",
]
