"""The 1X curves of a run as a small script of its own, which the page loads when the run is chosen.

A script, because a page opened from a disk may load those but not read files. What is written once stays: a
response of the catalogue is never changed.
"""

import json
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import Curve, curves, slow_roll_known, sweeps, thin_curve
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import write_whole_text

POINTS = 200  # of a probe, all its runs together
FORM = "// Curves of one run for the page of a lab, form 1\n"  # its number goes up when what follows changes


def is_written(path: Path) -> bool:
    """Return whether the script is there, in the form of this version."""
    try:
        with path.open(encoding="utf-8") as file:
            return file.readline() == FORM
    except (OSError, UnicodeDecodeError):
        return False


def write_bode_data(path: Path, run_id: str, response: OrderTrackedResponse) -> None:
    """Write the script with the curves of a run. Raises DataError if it cannot be written."""
    few = max(POINTS // max(len(sweeps(response)), 1), 2)
    probes = [
        {"name": name, "curves": [_table_of(thin_curve(curve, most=few)) for curve in curves(response, probe)]}
        for probe, name in enumerate(response.probes)
    ]
    table = {"probes": probes, "slow_roll_subtracted": slow_roll_known(response)}
    write_whole_text(path, f"{FORM}rotorLab.take({json.dumps(run_id)}, {as_script(table)});\n")


def as_script(table: object) -> str:
    r"""Return a table as JSON that neither ends a script element nor begins a comment in one.

    >>> as_script({"file": "</script>"})
    '{"file":"\\u003c/script>"}'
    """
    return json.dumps(table, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _table_of(curve: Curve) -> dict[str, object]:
    return {
        "run": curve.run,
        "direction": curve.direction,
        "rpm": _round(curve.rpm, 1),
        "amplitude": _round(curve.amplitude, 3),
        "lag": _round(curve.lag % 360.0, 1),
    }


def _round(values: NDArray[np.float64], decimals: int) -> list[float | None]:
    """Return values to so many decimals, None for what is not usable."""
    return [round(value, decimals) if math.isfinite(value) else None for value in values.tolist()]
