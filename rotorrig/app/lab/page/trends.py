"""Quantities that are followed over the months: estimates, residual, critical speed, amplification factor, peak."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from rotorrig.app.lab.page.catalogue import Catalogue, Row
from rotorrig.app.lab.page.numbers import shorten
from rotorrig.app.text import SHOWN, long_name
from rotorrig.rig.config import RPM, UM, Limits

WHOLE = "whole sweep"  # the fit of all speeds; others are named by their band
#: columns of a run's fit: name in the address, label, unit
OF_FIT = {
    "residual_um": ("residual", "residual, rms of 1X measured less fitted", "µm 0-peak"),
    "noise_um": ("noise", "noise of a vector, one standard deviation", "µm 0-peak"),
    "chi2_per_dof": ("chi2", "χ² per degree of freedom", ""),
}
#: columns of a peak, likewise
OF_PEAK = {
    "critical_speed_rpm": ("critical", "critical speed", "rpm"),
    "amplification_factor": ("factor", "amplification factor Q", ""),
    "peak_um": ("peak", "largest 1X", "µm 0-peak"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """One quantity of every run that has it, in its display unit."""

    name: str
    label: str
    group: str  # heading in the list that it is chosen from
    unit: str
    points: list[tuple[int, float, float | None, float | None]]  # index of the run, value, ends of the 95 % interval
    lines: dict[str, list[tuple[float, str]]]  # rig -> values to compare with, and what they are


def collect_trends(catalogue: Catalogue, limits: Mapping[str, Limits]) -> list[Trend]:
    """Return every quantity that some run has: estimates of the whole sweep, of bands, of the fit, of peaks.

    `limits` are the interlock's by the name of the rig, of those that have any.
    """
    of_estimates: dict[str, Trend] = {}
    of_fits: dict[str, Trend] = {}
    of_peaks: dict[str, Trend] = {}
    for index, run in enumerate(catalogue.runs):
        for row in catalogue.estimates.get(run["run_id"], []):
            _add_estimate(of_estimates, index, run["rig"], row)
        for column, (name, label, unit) in OF_FIT.items():
            trend = Trend(name=name, label=label, group="Fit", unit=unit, points=[], lines={})
            _add_point(of_fits, trend, index, run[column])
        for row in catalogue.peaks.get(run["run_id"], []):
            for column in OF_PEAK:
                _add_point(of_peaks, _trend_of_peak(row, column), index, row[column])
    for rig, its in limits.items():
        _add_limits(of_peaks, catalogue, rig, its)
    bands = sorted(of_estimates.values(), key=lambda trend: trend.group != WHOLE.capitalize())
    return [*bands, *of_fits.values(), *of_peaks.values()]


def display_unit(row: Row) -> tuple[str, float]:
    """Return the unit in which an estimate is shown, and the factor to it from SI.

    >>> display_unit({"unit": "N/m", "nameplate": 33.9e3}), display_unit({"unit": "", "nameplate": 0.0})
    (('kN/m', 0.001), ('%', 100.0))
    """
    unit = row["unit"] or ""
    if unit == "" and row["nameplate"] == 0:  # a relative deviation from the nameplate
        return "%", 100.0
    return SHOWN.get(unit, (unit, 1.0))


def _add_estimate(trends: dict[str, Trend], index: int, rig: str, row: Row) -> None:
    """Add a point of an estimate that its data determine."""
    if not row["determined"]:
        return
    fit, (unit, factor) = row["fit"] or WHOLE, display_unit(row)
    name = row["name"] if fit == WHOLE else f"{row['name']}, {fit}"
    group = fit[:1].upper() + fit[1:]
    trend = Trend(name=name, label=long_name(row["name"]), group=group, unit=unit, points=[], lines={})
    added = _add_point(trends, trend, index, row["value"], (row["low95"], row["high95"]), factor)
    if added and (nameplate := shorten(row["nameplate"], factor)):  # 0: none, or of a deviation from it
        trends[name].lines[rig] = [(nameplate, "nameplate")]


def _add_point(
    trends: dict[str, Trend],
    trend: Trend,
    index: int,
    value: float | None,
    interval: Sequence[float | None] = (None, None),
    factor: float = 1.0,
) -> bool:
    """Add a point to the trend of that name, which is begun if there is none; return whether there was a value."""
    shown = shorten(value, factor)
    if shown is None:
        return False
    low, high = (shorten(end, factor) for end in interval)
    trends.setdefault(trend.name, trend).points.append((index, shown, low, high))
    return True


def _trend_of_peak(row: Row, column: str) -> Trend:
    name, label, unit = OF_PEAK[column]
    where = f"{row['probe']} {row['run']}"
    return Trend(name=f"{name} {where}", label=f"{label}, {where}", group="Peaks", unit=unit, points=[], lines={})


def _add_limits(trends: dict[str, Trend], catalogue: Catalogue, rig: str, limits: Limits) -> None:
    """Add the limits of a rig's config: of vibration at its critical speed, and the band that this is to stay in."""
    rows = [row for run in catalogue.runs if run["rig"] == rig for row in catalogue.peaks.get(run["run_id"], [])]
    for probe, run in dict.fromkeys((row["probe"], row["run"]) for row in rows):
        its = [row for row in rows if (row["probe"], row["run"]) == (probe, run)]
        speeds = [row["critical_speed_rpm"] for row in its if shorten(row["critical_speed_rpm"]) is not None]
        usual = median(speeds) / RPM if speeds else 0.0
        band = next((band for band in limits.critical_bands if band.low <= usual <= band.high), None)
        held = limits if band is None else band
        peak = trends.get(f"peak {probe} {run}")
        if peak:
            limit = round(held.probes.get(probe, held.vibration) * UM, 3)
            peak.lines[rig] = [(limit, "limit of vibration, all orders")]
        if band:
            ends = ((band.low, "lower end of the critical band"), (band.high, "upper end of the critical band"))
            trends[f"critical {probe} {run}"].lines[rig] = [(round(end * RPM, 1), words) for end, words in ends]
