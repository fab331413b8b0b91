"""The catalogue of a lab as pages that open in a browser without a server: table of runs, trends, Bode plots overlaid.

`catalogue` reads the tables, `runs` and `trends` turn them into what the page shows, `bode_data` writes the curves of a
run, `curve_files` those of all, `pages` puts all of it into a folder. What the page does is in assets/lab.js, what it
draws in assets/lab-plots.js.
"""

from rotorrig.app.lab.page.bode_data import write_bode_data
from rotorrig.app.lab.page.pages import LabPage, write_lab_page

__all__ = [
    "LabPage",
    "write_bode_data",
    "write_lab_page",
]
