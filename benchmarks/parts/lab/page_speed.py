"""How long the pages of a lab take to make, and to open.

The lab is made up (tests/app/lab/page/catalogue_maker.py): three rigs over two years. Its responses are the closed form
of tests/app/conftest.py, 740 rows of four probes and three orders, one file linked many times. Chromium opens the page
from the disk, without a window, and says when the table was first painted.
"""

import shutil
import statistics
import tempfile
import time
from pathlib import Path

from rotorrig.app.lab import Lab, query_table
from rotorrig.app.lab.page import write_bode_data, write_lab_page
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import write_response
from rotorrig.rig.config import bundled_configs, load
from tests.app.browser import browser
from tests.app.conftest import make_response
from tests.app.lab.page.catalogue_maker import make_lab

OPENINGS = 5


def measure_page(runs: int = 1000) -> dict[str, float]:
    """Return seconds to make the pages of a lab and milliseconds to open them, by what they are of.

    page_seconds: with a response for every run that did not fail, whose curves `rotor lab run` has kept, all new.
    page_seconds_again: the same when the pages are there. page_seconds_reading: all new, of a lab that kept no curves,
    so that every response is read. page_open_ms and page_open_first_ms: from the request to the table's first paint,
    median and first of several; page_index_mb, its size.
    """
    with tempfile.TemporaryDirectory(prefix="rotor-lab-") as folder:
        root = Path(folder)
        lab, response = root / "a lab", make_response(load(bundled_configs()["rk4"]))
        write_response(root / "response.mcap", response)
        make_lab(lab, runs=runs, response=root / "response.mcap", responses=runs)
        reading = _seconds(lab)
        _keep_curves(lab, response)
        shutil.rmtree(lab / "lab" / "page")
        times = {"page_seconds": _seconds(lab), "page_seconds_again": _seconds(lab), "page_seconds_reading": reading}
        index = lab / "lab" / "page" / "index.html"
        openings = _openings(index, root / "profile")
        return {
            **times,
            "page_open_ms": statistics.median(openings),
            "page_open_first_ms": openings[0],
            "page_index_mb": index.stat().st_size / 1e6,
        }


def _keep_curves(lab: Path, response: OrderTrackedResponse) -> None:
    """Write what `rotor lab run` keeps of the response of every run that has one."""
    for run in query_table(lab, "select run_id, key from runs where response_file is not null").to_pylist():
        path = Lab(lab).curves(run["run_id"], run["key"])
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bode_data(path, run["run_id"], response)


def _seconds(lab: Path) -> float:
    """Return how long the pages of a lab take to make."""
    begin = time.perf_counter()
    write_lab_page(lab, lab / "lab" / "page")
    return time.perf_counter() - begin


def _openings(index: Path, profile: Path) -> list[float]:
    """Return the milliseconds to the table's first paint, of several openings in one browser."""
    with browser(profile) as tab:
        tab.look(width=1280)
        times = []
        for _ in range(OPENINGS):
            tab.open(index, wait="rotorLab.shown")
            times.append(float(tab.run("rotorLab.shown")))
        return times


if __name__ == "__main__":
    for name, value in measure_page().items():
        print(f"{name:>20} {value:8.2f}")
