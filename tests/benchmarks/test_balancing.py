"""What is counted of balanced rigs, and one of them."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks.balancing import summarise
from benchmarks.parts.balancing.case_run import Case, holes_of, run_case, trial_mass

ROOT = Path(__file__).parents[2]


def found(factor: float, *, held: bool = True, at_noise: bool = False, inside: float = 0.95) -> dict[str, Any]:
    judged = {"factor": factor, "expected": factor, "held": held, "no_worse": held}
    return {**judged, "at_noise": at_noise, "inside": inside}


def kept(name: str, kind: str, **methods: Any) -> dict[str, Any]:
    return {"name": name, "kind": kind, "version": "v", "ending": "ended", **methods}


def test_bars_are_counted_of_all_cases_and_noise_counts_as_reached() -> None:
    lines = [
        kept("a", "one plane", by_trial=found(40.0), by_fit=found(9.0, held=False), in_holes=found(20.0)),
        kept("b", "one plane", by_trial=found(4.0, at_noise=True), by_fit=found(30.0), in_holes=found(12.0)),
        kept("c", "one plane", by_trial=found(9.0), error="probe 2y: 919 um at 908 rpm"),
        kept("d", "two planes", by_trial=found(6.0, inside=0.9)),
        kept("e", "two planes", ending="killed"),
    ]
    result = summarise(lines, wanted=9)
    assert (result["trial_tenfold"]["hits"], result["trial_tenfold"]["of"]) == (2, 3)
    assert (result["two_planes_fivefold"]["hits"], result["two_planes_fivefold"]["of"]) == (1, 2)
    assert (result["fit_held"]["hits"], result["fit_held"]["of"]) == (1, 3)
    assert (result["fit_fivefold"]["hits"], result["holes_held"]["hits"]) == (2, 2)
    assert (result["trial_factor_median"], result["holes_factor_median"]) == (9.0, 16.0)
    assert result["inside_mean"] == pytest.approx(0.944, abs=1e-3)
    assert (result["errors"], result["cases"], result["wanted"], result["version"]) == (2, 5, 9, ["v"])


def test_rigs_have_as_many_disks_as_planes_and_masses_to_their_measure() -> None:
    one, two = Case(kind="one plane", seed=3).rig, Case(kind="two planes", seed=3).rig
    assert (len(one.disks), len(two.disks)) == (1, 2)
    disk = one.disks[0]
    assert disk.unbalance is not None
    holes = holes_of(one, disk.name)
    assert holes.masses[-1] * holes.radius == pytest.approx(disk.unbalance.amount, rel=0.05)
    force = abs(trial_mass(one, disk.name)) * one.plans["default"].fastest ** 2
    assert force == pytest.approx(0.1 * disk.mass * 9.81, rel=0.01)


@pytest.mark.campaign
def test_a_rig_of_two_planes_comes_down() -> None:
    line = {key: value for part in run_case(Case(kind="two planes", seed=4)) for key, value in part.items()}
    assert "error" not in line
    assert line["by_trial"]["factor"] > 5
    assert line["by_trial"]["inside"] > 0.85


def test_a_fresh_clone_prints_what_is_kept() -> None:
    command = [sys.executable, "benchmarks/balancing.py", "--summary", "--json"]
    printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    result = json.loads(printed.stdout.splitlines()[-1])
    assert {"trial_tenfold", "two_planes_fivefold", "fit_held", "holes_held", "inside_mean", "version"} <= set(result)
