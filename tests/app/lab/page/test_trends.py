"""Trends are the catalogue's values in display units, with what the config sets them against."""

from pathlib import Path
from typing import Any

import pytest

from rotorrig.app.lab.page.catalogue import Catalogue, read_catalogue
from rotorrig.app.lab.page.trends import Trend, collect_trends
from rotorrig.rig.config import Limits
from tests.app.lab.page.catalogue_maker import RIGS, estimate, write_run

RPM = 3.141592653589793 / 30  # rad/s


@pytest.fixture
def catalogue(tmp_path: Path) -> Catalogue:
    peak = {"run": "up", "probe": "1x", "critical_speed_rpm": 2230.0, "peak_um": 187.5, "amplification_factor": None}
    write_run(
        tmp_path,
        "a",
        runs={"status": "done", "residual_um": 0.21, "chi2_per_dof": float("nan")},
        estimates=[
            estimate("kxx", 34_000.0, 300.0, "N/m", 33_900.0, fit="480 to 1500 rpm"),
            estimate("kxx", 34_000.0, 300.0, "N/m", 33_900.0),
            estimate("u", 1.5e-5, 1e-7, "kg m", 1.4e-5, high95=float("inf")),
            estimate("phase", 0.5, 0.01, "rad", 0.0),
            estimate("cxx", 15.0, 99.0, "N s/m", 15.0, determined=False),
            estimate("disk mass", 0.01, 0.001, "", 0.0),
        ],
        peaks=[peak, {**peak, "run": "down", "critical_speed_rpm": 2200.0}],
    )
    write_run(tmp_path, "b", runs={"status": "failed"})
    return read_catalogue(tmp_path)


def trends(catalogue: Catalogue, limits: dict[str, Limits] | None = None) -> dict[str, Trend]:
    return {trend.name: trend for trend in collect_trends(catalogue, limits or {})}


def make_limits(**more: Any) -> Limits:
    plain = {"overspeed": 400.0, "vibration": 400e-6, "probes": {"1x": 300e-6}, **more}
    return Limits.model_validate(plain, context={"si": True})


def test_estimates_are_in_display_units_with_their_intervals_and_nameplate(catalogue: Catalogue) -> None:
    found = trends(catalogue)
    assert found["kxx"].unit == "kN/m"
    assert found["kxx"].points == [(0, 34.0, 33.4, 34.6)]
    assert found["kxx"].lines == {RIGS[0]: [(33.9, "nameplate")]}
    assert found["u"].points == [(0, 15.0, 14.8, None)]  # an end that is not known is none
    assert found["phase"].points[0][1] == pytest.approx(28.6479, abs=1e-4)  # 0.5 rad
    assert found["phase"].lines == {}  # an angle has no nameplate
    assert (found["disk mass"].unit, found["disk mass"].points[0][:2]) == ("%", (0, 1.0))


def test_what_the_data_do_not_determine_and_what_is_not_known_has_no_point(catalogue: Catalogue) -> None:
    found = trends(catalogue)
    assert "cxx" not in found
    assert "chi2" not in found
    assert "factor 1x up" not in found
    assert found["residual"].points == [(0, 0.21, None, None)]


def test_fits_of_a_band_come_after_those_of_the_whole_sweep_under_their_own_heading(catalogue: Catalogue) -> None:
    names = [(trend.group, trend.name) for trend in collect_trends(catalogue, {})]
    assert names[0] == ("Whole sweep", "kxx")
    assert names[4] == ("480 to 1500 rpm", "kxx, 480 to 1500 rpm")
    assert [name for group, name in names if group == "Peaks"][:2] == ["critical 1x up", "peak 1x up"]


def test_a_peak_is_held_against_the_limit_of_its_probe(catalogue: Catalogue) -> None:
    found = trends(catalogue, {RIGS[0]: make_limits()})
    assert found["peak 1x up"].lines == {RIGS[0]: [(300.0, "limit of vibration, all orders")]}
    assert found["critical 1x up"].lines == {}
    assert trends(catalogue, {"another rig": make_limits()})["peak 1x up"].lines == {}


def test_within_a_critical_band_its_limit_counts_and_the_speed_is_to_stay_in_it(catalogue: Catalogue) -> None:
    band = {"low": 2210 * RPM, "high": 2400 * RPM, "vibration": 800e-6}
    found = trends(catalogue, {RIGS[0]: make_limits(critical_bands=[band])})
    assert found["peak 1x up"].lines[RIGS[0]] == [(800.0, "limit of vibration, all orders")]
    assert [line[0] for line in found["critical 1x up"].lines[RIGS[0]]] == [2210.0, 2400.0]
    assert found["peak 1x down"].lines[RIGS[0]][0][0] == 300.0  # 2200 rpm is outside
    assert found["critical 1x down"].lines == {}
