"""A run as a row of the page's table, in display units."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from rotorrig.app.lab.page.catalogue import Catalogue, Row
from rotorrig.app.lab.page.numbers import shorten
from rotorrig.app.lab.page.trends import WHOLE, display_unit

#: columns of the table that are estimates: a rig with several bearings or disks shows its first there
FIRST = ("kxx", "cxx", "u")


def row_of_run(catalogue: Catalogue, run: Row, *, report: str | None, bode: str | None) -> dict[str, Any]:
    """Return what the page says of a run, without what is not known; `report` and `bode` are addresses of files."""
    estimates = catalogue.estimates.get(run["run_id"], [])
    table = {
        "id": run["run_id"],
        "file": run["file"],
        "t": _milliseconds(run["recorded_at"]),
        "rig": run["rig"],
        "status": run["status"],
        "step": run["step"],
        "sentence": run["sentence"],
        "verdict": run["verdict"],
        "causes": [row["words"] or row["label"] for row in catalogue.causes.get(run["run_id"], []) if row["chosen"]],
        "undetermined": [row["name"] for row in _whole(estimates) if not row["determined"]],
        "residual": shorten(run["residual_um"]),
        "speeds": [shorten(run["lowest_speed_rpm"]), shorten(run["highest_speed_rpm"])],
        "seconds": shorten(run["duration_s"]),
        "code": run["code_version"],
        "config": run["config_hash"],
        "report": report,
        "bode": bode,
        **{name: _first_estimate(estimates, name) for name in FIRST},
        **_largest_peak(catalogue.peaks.get(run["run_id"], [])),
    }
    return {name: value for name, value in table.items() if value not in (None, "", [], [None, None])}


def _milliseconds(time: datetime | None) -> int | None:
    """Return a time as JavaScript counts it."""
    return None if time is None else round(time.timestamp() * 1000)


def _whole(estimates: Sequence[Row]) -> list[Row]:
    """Return the estimates of the whole sweep; of the first fit if that was not fitted as a whole."""
    fits = [row["fit"] for row in estimates]
    shown = WHOLE if WHOLE in fits else next(iter(fits), None)
    return [row for row in estimates if row["fit"] == shown]


def _first_estimate(estimates: Sequence[Row], quantity: str) -> list[Any] | None:
    """Return value, sigma and, where it is one of several, the name of the first estimate of a quantity."""
    its = [row for row in _whole(estimates) if quantity in (row["name"].split()[0], row["name"].split()[-1])]
    if not its or not its[0]["determined"]:
        return None
    factor = display_unit(its[0])[1]
    value, sigma = (shorten(its[0][column], factor) for column in ("value", "sigma"))
    return None if value is None else [value, sigma, *([its[0]["name"]] if its[0]["name"] != quantity else [])]


def _largest_peak(peaks: Sequence[Row]) -> dict[str, Any]:
    """Return critical speed, amplification factor and place of the largest 1X peak of a run."""
    known = [row for row in peaks if shorten(row["critical_speed_rpm"]) and shorten(row["peak_um"])]
    if not known:
        return {}
    peak = max(known, key=lambda row: row["peak_um"])
    return {
        "critical": shorten(peak["critical_speed_rpm"]),
        "q": shorten(peak["amplification_factor"]),
        "peak": shorten(peak["peak_um"]),
        "where": f"{peak['probe']} {peak['run']}",
    }
