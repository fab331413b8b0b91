"""The blind benchmark draws, names, judges and counts as it says."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.blind import has_lam, in_turns, is_good
from benchmarks.parts.blind.cases import Case, cases, files, modelled, nameplate, outsiders, sizes, write_whole
from benchmarks.parts.blind.lam import Lam, compute, lam_file, lam_of
from benchmarks.parts.blind.names import ANSWERS, answer, effect_of
from benchmarks.parts.blind.page import page, text
from benchmarks.parts.blind.score import Rate, Score, rates, score, summarise
from rotorrig.sims.effects.base import catalogue
from rotorrig.sims.plant.draw import draw, expected_estimates
from rotorrig.sims.plant.faults.base import fault_names
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.truth import FaultSpec, Truth

BOW = Case(design="P2", faults=("bow",), seed=3)


def truth_of(case: Case) -> Truth:
    return draw(case.rig, seed=case.plant_seed, faults=sizes(case))


def cause(label: str, *, chosen: bool = True, theta: dict[str, float] | None = None, sigma: float = 1.0) -> Any:
    theta = theta or {}
    return {"label": label, "chosen": chosen, "theta": theta, "sigmas": dict.fromkeys(theta, sigma)}


def diagnosis(verdict: str, *causes: Any, tied: Any = (), gain: Any = None) -> dict[str, Any]:
    return {"verdict": verdict, "causes": list(causes), "tied": [list(t) for t in tied], "gain": gain or {}}


def test_every_fault_is_either_answered_by_an_effect_or_an_outsider() -> None:
    assert {*modelled(), *outsiders()} == set(fault_names())
    assert set(ANSWERS) == set(modelled())
    assert set(outsiders()) == {"loose_disk", "loose_pedestal", "probe_curvature", "slipping_coupling"}


@pytest.mark.parametrize("design", ["P1", "P2"])
@pytest.mark.parametrize("fault", modelled())
def test_an_answer_speaks_the_words_of_the_library(design: Any, fault: str) -> None:
    known = {effect.label: effect for effect in catalogue(nameplate(design))}
    for seed in range(6):
        case = Case(design=design, faults=(fault,), seed=seed)
        found = answer(case.rig, truth_of(case), sizes(case)[0])
        assert found.exact in found.labels
        assert {label.split(", recording")[0] for label in found.labels} <= set(known)
        assert set(found.theta) == {p.name for p in known[found.exact].parameters}
        assert set(found.same) <= set(found.theta)


def test_an_angle_is_told_from_the_keyphasors_edge() -> None:
    truth = replace(truth_of(BOW), keyphasor_offset=0.25)
    hidden = FaultSpec(name="couple", parameters={"skew": 2e-3, "angle": math.pi / 2 - 0.25, "disk": 0.0})
    theta = answer(BOW.rig, truth, hidden).theta
    assert theta["skew re"] == pytest.approx(0, abs=1e-12)
    assert theta["skew im"] == pytest.approx(2e-3)
    plain = expected_estimates(BOW.rig, truth)["phase"] - truth.unbalances[0].angle
    assert math.remainder(plain - 0.25, math.tau) == pytest.approx(0, abs=1e-12)


def test_an_oval_track_counts_as_runout_of_its_plane() -> None:
    hidden = FaultSpec(name="runout", parameters={"probe": 3.0})
    assert answer(BOW.rig, truth_of(BOW), hidden).labels == ("runout, plane 2", "runout, plane 2, twice per turn")


def test_hum_counts_in_whichever_recording_it_was_found() -> None:
    hum = Case(design="P2", faults=("line_hum",), seed=0)
    assert "line_hum, 50 Hz, recording 2" in answer(hum.rig, truth_of(hum), sizes(hum)[0]).labels


def test_a_screw_between_two_places_of_the_scan_may_be_called_either() -> None:
    hidden = FaultSpec(name="unbalance_plane", parameters={"position": 0.385})
    found = answer(BOW.rig, truth_of(BOW), hidden)
    assert found.labels == ("unbalance_plane, at 400 mm", "unbalance_plane, at 360 mm")


def test_cases_are_those_of_their_seed_and_no_two_are_one_rig() -> None:
    first, again = (list(cases("P1", seeds=2, healthy=3, pairs=4)) for _ in range(2))
    assert first == again
    assert [c.kind for c in first].count("healthy") == 3
    assert [c.kind for c in first].count("pair") == 4
    assert len({c.plant_seed for c in [*first, *cases("P2", seeds=2, healthy=3, pairs=4)]}) == 2 * len(first)
    assert sizes(first[0]) == sizes(again[0])
    assert all(c.plant_seed > 10**6 for c in first), "seeds that thresholds were set on are small"


def test_the_command_line_can_ask_for_some_faults_alone() -> None:
    asked = list(cases("P2", seeds=2, healthy=9, pairs=9, effects=["bow", "loose_disk"]))
    assert [c.name for c in asked] == ["bow-0", "bow-1", "loose_disk-0", "loose_disk-1"]
    assert [c.kind for c in asked] == ["single", "single", "outsider", "outsider"]


def test_a_run_that_is_stopped_has_as_large_a_part_of_every_fault() -> None:
    wanted = [case for design in ("P1", "P2") for case in cases(design, seeds=4, healthy=8, pairs=4)]
    half = in_turns(wanted)[: len(wanted) // 2]
    assert sorted(map(repr, in_turns(wanted))) == sorted(map(repr, wanted))
    for design in ("P1", "P2"):
        mine = [case for case in half if case.design == design]
        assert {c.faults[0]: c.seed for c in mine if c.kind == "single"} == dict.fromkeys(modelled(), 1)
        assert [c.seed for c in mine if c.kind == "healthy"] == [0, 1, 2, 3]
        assert sum(c.kind == "pair" for c in mine) == 2


def test_one_plane_has_two_probes_and_the_same_rotor() -> None:
    one, two = nameplate("P1"), nameplate("P2")
    assert [probe.name for probe in one.probes] == ["1x", "1y"]
    assert len(two.probes) == 4
    assert (one.shaft, one.disks, one.bearings, one.prior) == (two.shaft, two.disks, two.bearings, two.prior)


def test_the_right_name_counts_whether_it_stands_alone_or_in_a_tie() -> None:
    truth = truth_of(BOW)
    named = score(BOW, diagnosis("named", cause("bow"), cause("couple", chosen=False)), truth)
    tied = score(BOW, diagnosis("tied", cause("couple"), tied=[("couple", "bow")]), truth)
    wrong = score(BOW, diagnosis("named", cause("couple")), truth)
    missed = score(BOW, diagnosis("adequate", cause("bow", chosen=False)), truth)
    assert [s.in_set for s in (named, tied, wrong, missed)] == [True, True, False, False]
    assert [s.top1 for s in (named, tied, wrong, missed)] == [True, False, False, False]
    assert [s.wrong_unique for s in (named, tied, wrong, missed)] == [False, False, True, False]
    assert [s.detected for s in (named, tied, wrong, missed)] == [True, True, True, False]


def test_both_faults_of_a_pair_have_to_be_named() -> None:
    case = Case(design="P2", faults=("bow", "delay"), seed=0)
    truth = truth_of(case)
    half = score(case, diagnosis("named", cause("bow")), truth)
    whole = score(case, diagnosis("named", cause("bow"), cause("delay", theta={"delay": 1e-4})), truth)
    assert (half.in_set, whole.in_set) == (False, True)
    assert not half.wrong_unique
    seen, near = Lam(lam=900.0, rival_lam=16.0, rival=""), Lam(lam=900.0, rival_lam=15.9, rival="couple")
    found = rates([replace(half, lam=near), replace(whole, lam=seen)])
    assert found["pairs_contained"] == Rate(hits=1, of=2)
    assert found["pairs_contained_nameable"] == Rate(hits=1, of=1)


def test_an_interval_is_asked_for_what_both_sides_mean_alike() -> None:
    case = Case(design="P2", faults=("delay",), seed=0)
    truth = draw(case.rig, seed=1, faults=[FaultSpec(name="delay", parameters={"time": 1e-4})])
    near, far = ({"delay": value} for value in (1.19e-4, 1.21e-4))
    hit, missed = (score(case, diagnosis("named", cause("delay", theta=t, sigma=1e-5)), truth) for t in (near, far))
    assert (hit.covered, missed.covered) == ((True,), (False,))
    unbounded = cause("delay", theta=far) | {"sigmas": {"delay": None}}  # as diagnosis.json writes infinity
    assert score(case, diagnosis("named", unbounded), truth).covered == (True,)


def test_stiffness_and_unbalance_are_judged_in_standard_deviations() -> None:
    truth = truth_of(BOW)
    sought = expected_estimates(BOW.rig, truth)
    base = {
        "kxx": {"before": 0.0, "after": sought["kxx"] + 30.0, "sigma": 20.0},
        "cxx": {"before": 0.0, "after": 99.0, "sigma": 1.0},
    }
    found = score(BOW, diagnosis("named", cause("bow"), gain={"over_noise_floor": 1.1, "base": base}), truth)
    assert found.errors == (pytest.approx(1.5),)
    assert found.over_floor == 1.1


def judged(verdict: str, *, lam: Lam | None = None, **more: Any) -> Score:
    return Score(case=BOW, verdict=verdict, right=(frozenset({"bow"}),), lam=lam, **more)


def test_only_what_can_be_seen_is_asked_for() -> None:
    invisible = Lam(lam=24.9, rival_lam=24.9, rival="couple")
    unnameable = Lam(lam=900.0, rival_lam=15.9, rival="couple")
    fair = Lam(lam=900.0, rival_lam=16.0, rival="couple")
    scores = [
        judged("adequate", lam=invisible),
        judged("tied", lam=unnameable, first="couple", named=frozenset({"couple", "bow"})),
        judged("named", lam=fair, first="bow", named=frozenset({"bow"})),
        judged("named", lam=fair, first="couple", named=frozenset({"couple"})),
    ]
    found = rates(scores)
    assert found["detectable"] == Rate(hits=3, of=4)
    assert found["nameable"] == Rate(hits=2, of=4)
    assert found["detected"] == Rate(hits=3, of=3)
    assert found["top1"] == Rate(hits=1, of=2)
    assert found["in_set"] == Rate(hits=2, of=3)
    assert found["tied_not_nameable"] == Rate(hits=1, of=1)
    assert found["wrong_unique"] == Rate(hits=1, of=4)


def test_a_case_whose_lam_is_not_known_is_in_no_rate_that_asks_for_it() -> None:
    found = rates([judged("named", first="bow", named=frozenset({"bow"})), judged("adequate")])
    asking = ("detectable", "nameable", "detected", "top1", "in_set", "in_set_nameable", "tied_not_nameable")
    assert [found[name].of for name in asking] == [0] * len(asking)
    assert found["wrong_unique"].of == 2
    written = text({"P2": [judged("adequate")]}, {"P2": summarise([judged("adequate")], wanted=7)})
    assert "lam was computed for 0 of 1 cases of faults that an effect models; the others are in no rate" in written
    assert "cases run: 1 of 7 asked for" in written


def test_a_cause_beside_the_right_one_is_told() -> None:
    alone, beside = (frozenset({"bow"}), frozenset({"bow", "delay"}))
    found = rates([judged("named", chosen=c, named=c) for c in (alone, beside)])
    assert found["another_beside"] == Rate(hits=1, of=2)


def test_alarms_are_counted_on_healthy_rigs_and_unexplained_ones_on_outsiders() -> None:
    healthy = [Score(case=Case(design="P2", seed=i), verdict="named" if i == 0 else "adequate") for i in range(50)]
    odd = Case(design="P2", faults=("loose_disk",), seed=0)
    outside = [Score(case=odd, verdict=verdict) for verdict in ("unexplained", "named", "adequate")]
    found = rates([*healthy, *outside])
    assert found["false_alarm"] == Rate(hits=1, of=50)
    assert found["outsiders_unexplained"] == Rate(hits=1, of=2)


def test_bounds_are_those_of_clopper_and_pearson() -> None:
    assert Rate(hits=10, of=20).bounds == (pytest.approx(0.2720, abs=1e-4), pytest.approx(0.7280, abs=1e-4))
    assert Rate(hits=0, of=200).bounds == (0.0, pytest.approx(1 - 0.025 ** (1 / 200)))  # closed form
    assert Rate(hits=0, of=0).share is None


def test_a_failed_case_is_a_missed_one() -> None:
    found = rates([judged("failed", error="Traceback", lam=Lam(lam=30.0, rival_lam=25.0, rival=""))])
    assert found["detected"] == Rate(hits=0, of=1)
    assert found["failed"] == Rate(hits=1, of=1)


def test_a_failed_healthy_case_is_no_proof_of_silence() -> None:
    found = rates([Score(case=Case(design="P2", seed=0), verdict="failed")])
    assert found["false_alarm"] == Rate(hits=0, of=0)


def test_a_case_that_ended_in_an_error_is_run_again_and_no_other(tmp_path: Path) -> None:
    (tmp_path / "P2").mkdir()
    assert not is_good(BOW, tmp_path)
    write_whole(files(BOW, tmp_path)[0], {"diagnosis": {"verdict": "failed"}})
    assert not is_good(BOW, tmp_path)
    write_whole(files(BOW, tmp_path)[0], {"diagnosis": {"verdict": "named"}})
    assert is_good(BOW, tmp_path)


def test_the_summary_is_json_with_a_count_behind_every_rate() -> None:
    scores = [
        judged(
            "named", first="bow", named=frozenset({"bow"}), over_floor=1.1, covered=(True, False), errors=(1.0, -3.0)
        ),
        Score(case=Case(design="P2", seed=0), verdict="adequate", seconds=12.0),
    ]
    summary = summarise(scores)
    asked = "cases detected top1 in_set wrong_unique false_alarm outsiders_unexplained heldout_over_floor coverage95"
    assert {*asked.split(), "seconds_per_case"} <= set(summary)
    assert summary["counts"]["coverage95"]["of"] == 2
    assert summary["rms_sigma"] == pytest.approx(math.sqrt(5))
    assert summary["mean_sigma"] == pytest.approx(-1)
    assert json.loads(json.dumps(summary)) == summary
    written = page({"P2": scores}, {"P2": summary}, versions=["1.0"])
    assert "| bow" in written
    assert "Taken for" in written
    assert "50.0%" in text({"P2": scores}, {"P2": summary})


def test_nothing_done_yet_can_be_summarised() -> None:
    summary = summarise([])
    assert summary["detected"] is None
    assert "0 of 0" in page({"P1": []}, {"P1": summary}, versions=[])


def test_the_sealed_truth_lies_beside_the_diagnosis_and_holds_the_fault(tmp_path: Path) -> None:
    path, sealed = files(BOW, tmp_path)
    path.parent.mkdir()
    seal(truth_of(BOW), sealed)
    write_whole(path, {"verdict": "named"})
    assert unseal(sealed).faults == sizes(BOW)
    assert sorted(p.name for p in path.parent.iterdir()) == ["bow-3.json", "bow-3.sealed.json"]


def test_lam_that_cannot_be_computed_is_tried_again(tmp_path: Path) -> None:
    (tmp_path / "P2").mkdir()
    files(BOW, tmp_path)[1].write_text("no truth")
    assert lam_of(BOW, tmp_path) is None
    compute((BOW, tmp_path))
    assert lam_of(BOW, tmp_path) is None
    assert not has_lam(BOW, tmp_path)
    assert has_lam(Case(design="P2", seed=0), tmp_path), "nothing is asked of a healthy rig"
    assert "no JSON" in lam_file(BOW, tmp_path).read_text()


def test_the_effect_stands_before_the_place() -> None:
    assert effect_of("runout, plane 1, twice per turn") == "runout"
    assert np.all([effect_of(e.label) == e.name for e in catalogue(nameplate("P2"))])
