"""The blind benchmark draws, names, counts and keeps its cases as it says."""

import json
import math
import subprocess
import sys
import zlib
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import blind
from benchmarks.blind import examination, judge, line
from benchmarks.parts.blind.cases import (
    EXTENTS,
    OUTSIDERS,
    Case,
    Extent,
    cases,
    draw_again,
    modelled,
    nameplate,
    shuffle,
    sizes,
)
from benchmarks.parts.blind.measured import trial_mass
from benchmarks.parts.blind.nameplate_answers import answer_dimension, answer_rest
from benchmarks.parts.blind.names import ANSWERS, answer, effect_of
from benchmarks.parts.blind.records import Attempt, attempts, begin_attempt
from benchmarks.parts.blind.rigs.deviants import DEVIANTS, Deviation
from benchmarks.parts.blind.rigs.drawn import draw_rig
from benchmarks.parts.blind.rigs.fault_sizes import fault_of
from benchmarks.parts.discovery.wanted import later_outsiders
from rotorrig.sims.effects.base import catalogue
from rotorrig.sims.plant.draw import draw, expected_estimates
from rotorrig.sims.plant.faults.base import fault_names
from rotorrig.sims.plant.truth import FaultSpec, Truth

ROOT = Path(__file__).parents[2]
BOW = Case(design="P2", faults=("bow",), seed=3)
ATTEMPT = Attempt(number=2, begun="2026-11-24", version="abc", first_seed=2000)


def truth_of(case: Case) -> Truth:
    return draw(case.rig, seed=case.plant_seed, faults=sizes(case))


def of_rk4(**hidden: Any) -> Case:
    """Return the first case that is of the RK4."""
    return next(c for s in range(3) if not (c := Case(seed=s, **hidden)).is_drawn)


def test_every_fault_is_answered_by_an_effect_or_an_outsider_here_or_for_discoveries_alone() -> None:
    assert set(ANSWERS) == set(modelled())
    assert {*modelled(), *OUTSIDERS, *later_outsiders()} == set(fault_names())
    assert later_outsiders() == (
        "damping_over_speed",
        "magnetic_pull",
        "probe_bracket",
        "seal",
        "snubber",
        "twice_line_pull",
        "unbalance_drift",
    )


def test_the_cases_are_those_that_the_kept_results_are_of() -> None:
    """As many, by the same names in the same order, as before there were faults for discoveries alone."""
    listed = {design: [c.name for c in cases(design, extent, first=2000)] for design, extent in EXTENTS.items()}
    assert {design: len(names) for design, names in listed.items()} == {"P2": 780, "P1": 230}
    marks = {design: zlib.crc32("\n".join(names).encode()) for design, names in listed.items()}
    assert marks == {"P2": 2887786450, "P1": 2792283207}
    ordered = [f"{c.design} {c.name}" for c in examination(ATTEMPT)]
    assert zlib.crc32("\n".join(ordered).encode()) == 1623414738


@pytest.mark.parametrize("fault", modelled())
def test_an_answer_speaks_the_words_of_the_library(fault: str) -> None:
    for rig in (nameplate("P1"), nameplate("P2"), draw_rig(0), draw_rig(2, planes=1)):
        known = {effect.label: effect for effect in catalogue(rig)}
        for seed in range(3):
            hidden = fault_of(rig, fault, seed=seed, runs=2)
            found = answer(rig, draw(rig, seed=seed, faults=[hidden]), hidden)
            assert found.exact in found.labels
            assert {label.split(", recording")[0] for label in found.labels} <= set(known)
            assert set(found.theta) == {p.name for p in known[found.exact].parameters}
            assert set(found.same) <= set(found.theta)


def test_an_angle_is_told_from_the_keyphasors_edge() -> None:
    case = of_rk4(design="P2", faults=("couple",))
    truth = replace(truth_of(case), keyphasor_offset=0.25)
    hidden = FaultSpec(name="couple", parameters={"skew": 2e-3, "angle": math.pi / 2 - 0.25, "disk": 0.0})
    theta = answer(case.rig, truth, hidden).theta
    assert theta["skew re"] == pytest.approx(0, abs=1e-12)
    assert theta["skew im"] == pytest.approx(2e-3)
    plain = expected_estimates(case.rig, truth)["phase"] - truth.unbalances[0].angle
    assert math.remainder(plain - 0.25, math.tau) == pytest.approx(0, abs=1e-12)


def test_an_oval_track_counts_as_runout_of_its_plane() -> None:
    case = of_rk4(design="P2", faults=("runout",))
    hidden = FaultSpec(name="runout", parameters={"probe": 3.0})
    assert answer(case.rig, truth_of(case), hidden).labels == ("runout, plane 2", "runout, plane 2, twice per turn")


def test_a_screw_between_two_places_of_the_scan_may_be_called_either() -> None:
    case = of_rk4(design="P2", faults=("unbalance_plane",))
    hidden = FaultSpec(name="unbalance_plane", parameters={"position": 0.385})
    found = answer(case.rig, truth_of(case), hidden)
    assert found.labels == ("unbalance_plane, at 400 mm", "unbalance_plane, at 360 mm")


def test_a_wrong_dimension_has_to_be_named_and_within_its_interval() -> None:
    found = answer_dimension(Deviation(kind="bearing_position", part="spring", value=0.002, asked=True))
    assert found.labels == ("bearing_position, spring",)
    assert (found.asked, found.interval, found.theta) == (True, True, {"off": 0.002})
    assert answer_dimension(Deviation(kind="diameter", part="", value=0.001, asked=False)).labels == ("diameter",)


def test_whatever_the_nameplate_has_wrongly_may_be_named() -> None:
    case = of_rk4(design="P2")
    truth = replace(truth_of(case), keyphasor_offset=0.19, probe_gain_factors=(1.07, 1.0, 1.0, 1.0))
    found = {each.exact: each for each in answer_rest(case.rig, truth)}
    assert found["keyphasor_angle"].theta == {"off": 0.19}
    assert found["probe_gain, probe 1x"].theta["error"] == pytest.approx(0.07)
    assert {"youngs_modulus", "disk_mass", "bearing_stiffness, left A x", "probe_angle, probe 2y"} <= found.keys()
    assert "bearing_stiffness, spring x" not in found, "that is sought"
    assert all(each.interval and not each.asked for each in found.values())


def test_cases_are_those_of_their_seed_and_no_two_are_one_rig() -> None:
    extent = Extent(seeds=2, healthy=3, pairs=4, outsiders=6, deviants=7)
    first, again = (list(cases("P1", extent)) for _ in range(2))
    assert first == again
    kinds = Counter(c.kind for c in first)
    assert kinds == {"single": 2 * len(modelled()), "healthy": 3, "pair": 4, "outsider": 6, "deviant": 7}
    assert {c.deviant for c in first if c.kind == "deviant"} == set(DEVIANTS)
    assert len({c.plant_seed for c in [*first, *cases("P2", extent)]}) == 2 * len(first)
    assert sizes(first[0]) == sizes(again[0])
    assert all(c.plant_seed > 10**6 for c in first), "seeds that thresholds were set on are small"


def test_the_command_line_can_ask_for_some_faults_alone() -> None:
    extent = Extent(seeds=2, healthy=9, pairs=9, outsiders=2, deviants=9)
    asked = list(cases("P2", extent, hidden=["bow", "loose_disk"]))
    assert [c.name for c in asked] == ["bow-0", "bow-1", "loose_disk-0", "loose_disk-1"]
    assert [c.kind for c in asked] == ["single", "single", "outsider", "outsider"]


def test_an_examination_has_the_cases_that_are_stated_on_seeds_of_its_own() -> None:
    wanted = examination(ATTEMPT)
    kinds = Counter((c.design, c.kind) for c in wanted)
    assert kinds["P2", "single"] == 10 * len(modelled())
    assert (kinds["P2", "healthy"], kinds["P2", "outsider"], kinds["P2", "pair"]) == (400, 40, 40)
    assert (kinds["P1", "single"], kinds["P1", "healthy"]) == (5 * len(modelled()), 100)
    assert min(c.seed for c in wanted) == 2000
    assert max(c.seed for c in wanted) < 3000


def test_a_third_of_all_cases_is_of_drawn_rigs() -> None:
    wanted = examination(ATTEMPT)
    assert sum(c.is_drawn for c in wanted) / len(wanted) == pytest.approx(1 / 3, abs=0.05)
    for fault in modelled():
        assert sum(c.is_drawn for c in wanted if c.faults == (fault,) and c.design == "P2") in (3, 4)


def test_the_order_is_fixed_by_the_attempt_and_mixes_all_kinds() -> None:
    wanted = [c for design, extent in EXTENTS.items() for c in cases(design, extent)]
    order = shuffle(wanted, attempt=1)
    assert order == shuffle(wanted, attempt=1) != shuffle(wanted, attempt=2)
    assert sorted(map(repr, order)) == sorted(map(repr, wanted))
    whole, part = (Counter(c.kind for c in some) for some in (order, order[: len(order) // 4]))
    for kind, count in whole.items():  # without replacement: within four standard deviations of its share
        spread = math.sqrt(count * (1 - count / len(order)) / 4)
        assert abs(part[kind] - count / 4) < 4 * spread, kind


def test_what_is_drawn_again_is_another_rig_of_another_size() -> None:
    again = draw_again(BOW)
    assert (again.name, again.again) == (BOW.name, 1)
    assert again.plant_seed != BOW.plant_seed
    assert sizes(again) != sizes(BOW)


def test_one_plane_has_two_probes_and_the_same_rotor() -> None:
    one, two = nameplate("P1"), nameplate("P2")
    assert [probe.name for probe in one.probes] == ["1x", "1y"]
    assert len(two.probes) == 4
    assert (one.shaft, one.disks, one.bearings, one.prior) == (two.shaft, two.disks, two.bearings, two.prior)


def test_a_trial_mass_pulls_with_a_tenth_of_the_disks_weight_at_the_highest_speed() -> None:
    drawn = next(c for s in range(3) if (c := Case(design="P2", seed=s)).is_drawn)
    amount, angle = trial_mass(drawn)
    disk, top = drawn.rig.disks[0], drawn.rig.plans["default"].fastest
    assert amount * top**2 == pytest.approx(0.1 * disk.mass * 9.81, rel=0.01)
    assert angle == pytest.approx(math.pi / 2)


def test_a_case_that_was_killed_before_its_verdict_is_kept_as_such() -> None:
    whole = {"verdict": "adequate", "rig": "rk4"}
    assert line(BOW, whole, "ended", version="v", number=1)["verdict"] == "adequate"
    assert line(BOW, whole, "killed", version="v", number=1)["verdict"] == "adequate", "it was at lam, or after it"
    killed = line(BOW, {"rig": "rk4"}, "killed", version="v", number=1)
    assert (killed["verdict"], killed["name"], killed["attempt"], killed["ending"]) == ("killed", "bow-3", 1, "killed")
    found = judge([BOW], {"P2 bow-3": json.loads(json.dumps(killed))})
    assert [s.verdict for s in found["P2"]] == ["killed"]


def test_the_effect_stands_before_the_place() -> None:
    assert effect_of("runout, plane 1, twice per turn") == "runout"
    assert np.all([effect_of(e.label) == e.name for e in catalogue(nameplate("P2"))])


def test_the_summary_of_a_fresh_clone_is_of_what_is_kept_in_the_repository(tmp_path: Path) -> None:
    """With the files that git has, and no cache: of the attempt that stands, else of the newest that has cases."""
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "-q", "--depth", "1", f"file://{ROOT}", clone], check=True, timeout=60)
    kept = clone / "benchmarks/parts/blind/results"
    attempts = [json.loads(text) for text in (kept / "attempts.jsonl").read_text().splitlines()]
    lines = {a["number"]: _lines_of(kept / f"attempt-{a['number']}.jsonl") for a in attempts}
    told = max(attempts, key=lambda a: (not a["superseded"], bool(lines[a["number"]]), a["number"]))
    done = subprocess.run(
        [sys.executable, "benchmarks/blind.py", "--json", "--summary"],
        cwd=clone,
        env={"PYTHONPATH": str(clone), "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["cases"] == len(lines[told["number"]]) > 0
    assert found["version"] == told["version"]
    assert not (clone / ".cache").exists()


def _lines_of(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def test_to_end_an_attempt_runs_no_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_attempt(tmp_path)
    for name in ("examine", "develop"):
        monkeypatch.setattr(blind, name, lambda options: pytest.fail("a case would be run"))
    monkeypatch.setattr(sys, "argv", ["blind.py", "--supersede", "a rehearsal", "--results", str(tmp_path)])
    blind.main()
    (ended,) = attempts(tmp_path)
    assert ended.superseded == "a rehearsal"
