"""Scores of lines that were made up, against shares worked out by hand."""

import json
import math
from typing import Any

import pytest

from benchmarks.parts.blind.page import page
from benchmarks.parts.blind.records import Attempt
from benchmarks.parts.blind.score import Rate, rates, score, summarise

FAIR = {"lam": 900.0, "rival_lam": 16.0, "rival": "couple"}
UNNAMEABLE = {"lam": 25.0, "rival_lam": 15.9, "rival": "couple"}
INVISIBLE = {"lam": 24.9, "rival_lam": 24.9, "rival": "couple"}


def right(*labels: str, exact: str = "", theta: Any = None, same: Any = (), **more: Any) -> dict[str, Any]:
    """Return the right answer for something hidden."""
    rest = {"disturbed": [], "asked": True, "interval": False} | more
    return {"labels": list(labels), "exact": exact or labels[0], "theta": theta or {}, "same": list(same)} | rest


def record(verdict: str, *named: str, faults: Any = ("bow",), deviant: str = "", **more: Any) -> dict[str, Any]:
    """Return a line: the causes that were taken up, what is hidden, as many seconds as are given."""
    hidden = more.pop("hidden", [right(fault) for fault in faults])
    chosen = {label: {"theta": {}, "sigmas": {}} for label in named} | more.pop("chosen", {})
    own = {"design": "P2", "faults": list(faults), "deviant": deviant, "seed": more.pop("seed", 1000), "again": 0}
    found = {"verdict": verdict, "first": next(iter(chosen), ""), "chosen": chosen, "tied": [], "hidden": hidden}
    return {**own, **found, "over_floor": None, "cut_short": False, "seconds": 1.0, "seconds_cpu": 0.5, **more}


def rate(name: str, *records: dict[str, Any]) -> tuple[int, int]:
    """Return hits and cases of one rate."""
    found = rates([score(json.loads(json.dumps(each))) for each in records])[name]
    return found.hits, found.of


SINGLES = (
    record("named", "bow", lam=FAIR),  # right
    record("named", "couple", lam=FAIR),  # wrong
    record("tied", "couple", tied=[["couple", "bow"]], lam=FAIR),  # right, second in a tie
    record("tied", "couple", tied=[["couple", "drag"]], lam=UNNAMEABLE),  # wrong, but for no certain name
    record("tied", "bow", tied=[["bow", "couple"]], lam=UNNAMEABLE),  # right
    record("named", "bow", "drag", lam=UNNAMEABLE),  # right, and one that is not there
    record("unexplained", "couple", lam=FAIR),  # found, not named
    record("adequate", lam=INVISIBLE),
    record("named", "bow"),  # lam not known
    record("failed", error="Traceback") | {"hidden": None, "chosen": None},
)


def test_shares_of_single_faults() -> None:
    counted = {name: rate(name, *SINGLES) for name in rates([])}
    assert counted["detectable"] == (7, 8)
    assert counted["nameable"] == (4, 8)
    assert counted["detected"] == (7, 7)
    assert counted["top1"] == (1, 4)  # of those with lam 900
    assert counted["in_set_nameable"] == (2, 4)
    assert counted["in_set"] == (4, 7)
    assert counted["tied_not_nameable"] == (1, 3)
    assert counted["named_right_all"] == (2, 10)  # the first, and the one whose lam is not known
    assert counted["in_set_all"] == (5, 10)
    assert counted["wrong_unique"] == (1, 10)
    assert counted["wrong_unique_all"] == (2, 10)  # drag beside the bow is one too
    assert counted["another_beside"] == (1, 5)
    assert counted["failed"] == (1, 10)


def test_every_wrong_name_counts_of_whatever_kind_the_case_is() -> None:
    every = (
        record("named", "drag", faults=()),  # healthy
        record("named", "drag", faults=("loose_disk",), hidden=[right("none", labels=[])]),  # an outsider
        record("named", "bow", "drag", faults=("bow", "delay")),  # of a pair one right, one not there
        record("named", "drag", faults=(), deviant="hub", hidden=[right("hub, disk", interval=True)]),
        record("named", "bow", faults=("bow", "delay")),  # half of a pair: nothing wrong is named
        record("unexplained", "drag", faults=()),
        record("tied", "bow", "drag", tied=[["bow", "runout"]], faults=("bow",)),  # drag is in no tie
        record("tied", "drag", tied=[["drag", "rub"]], faults=()),
    )
    assert rate("wrong_unique_all", *every) == (5, 8)
    assert rate("wrong_unique", *every) == (0, 3), "as it was: of single faults and pairs, nothing right at all"


def test_any_fault_named_on_a_healthy_rig_is_a_false_alarm() -> None:
    heavy = right("bearing_position, spring", theta={"off": 0.003}, same=["off"], interval=True, asked=False)
    found = {"bearing_position, spring": {"theta": {"off": 0.0031}, "sigmas": {"off": 1e-4}}}
    missed = {"bearing_position, spring": {"theta": {"off": 0.0033}, "sigmas": {"off": 1e-4}}}
    healthy = (
        record("named", "bow", faults=()),
        record("tied", "bow", tied=[["bow", "runout"]], faults=()),
        record("unexplained", faults=()),
        record("adequate", faults=()),
        record("cannot tell", faults=()),
        record("failed", faults=()),  # no proof of silence
        record("named", faults=(), hidden=[heavy], chosen=found),  # it does sit there
        record("named", faults=(), hidden=[heavy], chosen=missed),  # three sigmas beside it
    )
    assert rate("false_alarm", *healthy) == (3, 7)
    assert rate("healthy_found_wrong", *healthy) == (5, 7)


def deviant(verdict: str, label: str, off: float, **more: Any) -> dict[str, Any]:
    """Return a rig whose spring bearing sits 2 mm further than its nameplate says."""
    hidden = [right("bearing_position, spring", theta={"off": 0.002}, same=["off"], interval=True)]
    chosen = {label: {"theta": {"off": off}, "sigmas": {"off": 1e-4}}}
    return record(verdict, faults=(), deviant="bearing_position", hidden=hidden, chosen=chosen, **more)


def test_a_wrong_dimension_is_named_right_within_its_interval_alone() -> None:
    own, other = "bearing_position, spring", "disk_position, disk"
    deviants = (
        deviant("named", own, 0.00219),  # 1.9 sigmas
        deviant("named", own, 0.00221),  # 2.1 sigmas: wrong
        deviant("named", other, 0.002),  # a wrong member of its group
        deviant("named", "hysteresis", 0.002),  # a fault
        deviant("tied", other, 0.002, tied=[[other, own]]),  # tied with what is right
        deviant("unexplained", other, 0.002),
        record("adequate", faults=(), deviant="bearing_position", hidden=[right(own, interval=True)]),
    )
    assert rate("deviants_named", *deviants) == (1, 7)
    assert rate("deviants_false_alarm", *deviants) == (3, 7)
    assert rate("wrong_unique_all", *deviants) == (3, 7)
    assert rate("false_alarm", *deviants) == (0, 0), "they are not the healthy"


def test_outsiders_ought_to_be_unexplained_and_of_a_pair_both_named() -> None:
    odd = [record(v, "bow", faults=("loose_disk",), hidden=[right("", labels=[])]) for v in ("unexplained", "named")]
    unseen = record("adequate", faults=("loose_disk",), hidden=[right("", labels=[])])
    assert rate("outsiders_unexplained", *odd, unseen) == (1, 2)
    force = "found_force, stiffness"
    described = record("described", force, faults=("loose_disk",), hidden=[right("", labels=[])])
    assert rate("outsiders_unexplained", described) == (1, 1)
    assert rate("false_alarm", record("described", force, faults=(), hidden=[])) == (1, 1)
    two = ("bow", "delay")
    pairs = (
        record("named", "bow", "delay", faults=two, lam=FAIR),
        record("tied", "bow", "drag", tied=[["drag", "delay"]], faults=two, lam=UNNAMEABLE),
        record("named", "bow", faults=two, lam=FAIR),
    )
    assert rate("pairs_contained", *pairs) == (2, 3)
    assert rate("pairs_contained_nameable", *pairs) == (1, 2)


def test_stiffness_and_unbalance_are_held_against_the_truth_where_the_model_was_taken() -> None:
    """Errors of 1, -3 and 1.9 sigmas; kyy, which the fault changes, damping, and a sigma without end are left out."""
    adequate = record("adequate", faults=(), base={"kxx": [105.0, 5.0, 100.0], "cxx": [9.0, 1.0, 1.0]})
    hidden = [right("pedestal, x", disturbed=["kyy"])]
    base = {"kyy": [900.0, 1.0, 1.0], "u": [1.0, 1.0, 4.0], "left kxx": [3.9, 1.0, 2.0], "u disk 2": [1.0, None, 7.0]}
    named = record("named", "pedestal, x", faults=("pedestal",), hidden=hidden, base=base)
    summary = summarise([score(adequate), score(named)])
    assert summary["coverage_k_u"] == pytest.approx(2 / 3)
    assert summary["counts"]["coverage_k_u"]["of"] == 3
    assert summary["sigma_rms"] == pytest.approx(math.sqrt((1 + 9 + 1.9**2) / 3))
    assert summary["rms_sigma"] == pytest.approx(math.sqrt((9 + 1.9**2) / 2)), "of what was named rightly"
    assert summary["mean_sigma"] == pytest.approx((-3 + 1.9) / 2)


def test_hidden_parameters_lie_inside_the_intervals_of_what_was_named() -> None:
    hidden = [right("delay", theta={"delay": 1e-4}, same=["delay"])]
    chosen = [
        {"delay": {"theta": {"delay": value}, "sigmas": {"delay": sigma}}}
        for value, sigma in ((1.19e-4, 1e-5), (1.21e-4, 1e-5), (9e-4, None))
    ]
    cases = [record("named", faults=("delay",), hidden=hidden, chosen=each) for each in chosen]
    assert rate("coverage95", *cases) == (2, 3), "1.9 sigmas, 2.1 sigmas, no end"


def test_times_are_those_of_the_diagnosis() -> None:
    cases = [record("adequate", seconds=float(s)) for s in range(1, 101)] + [record("killed")]
    summary = summarise([score(each) for each in cases])
    assert summary["seconds_per_case"] == pytest.approx(50.5)
    assert summary["seconds_p95"] == pytest.approx(95.05)
    assert summary["seconds_worst"] == 100.0
    assert summary["cpu_per_case"] == 0.5
    assert summary["killed"] == pytest.approx(1 / 101)


def test_bounds_are_those_of_clopper_and_pearson() -> None:
    assert Rate(hits=10, of=20).bounds == (pytest.approx(0.2720, abs=1e-4), pytest.approx(0.7280, abs=1e-4))
    assert Rate(hits=0, of=200).bounds == (0.0, pytest.approx(1 - 0.025 ** (1 / 200)))  # closed form
    assert Rate(hits=0, of=0).share is None


def test_a_summary_is_json_with_a_count_behind_every_rate() -> None:
    summary = summarise([score(each) for each in SINGLES], wanted=40)
    for name in rates([]):
        assert {"hits", "of", "low", "high"} <= set(summary["counts"][name]), name
    assert (summary["cases"], summary["wanted"]) == (10, 40)
    assert json.loads(json.dumps(summary)) == summary


def test_the_page_has_every_attempt_and_bounds_beside_every_share() -> None:
    scores = [score(each) for each in SINGLES]
    ended = Attempt(
        number=1,
        begun="2026-11-23",
        version="old",
        first_seed=1000,
        superseded="a bug",
        until="x",
        verdicts={"tied": 7},
    )
    standing = Attempt(number=2, begun="2026-11-24", version="new", first_seed=2000)
    judged, summaries = {"P2": scores, "P1": []}, {"P2": summarise(scores, wanted=40), "P1": summarise([])}
    whole = page(judged, summaries, attempts=[ended, standing], told=standing)
    written = " ".join(whole.split())  # tables without their padding
    assert f"What follows is of attempt {standing.number}." in written
    one = "- **Attempt 1**, begun on 2026-11-23, version old, seeds from 1000: 7 tied. Superseded on x: a bug."
    assert f"{one} - **Attempt 2**, begun on 2026-11-24, version new, seeds from 2000: 1 adequate, 1 failed" in written
    assert "1 adequate, 1 failed, 4 named, 3 tied, 1 unexplained" in written
    assert "cases run: 10 of 40 asked for; 0 sweeps tripped and were drawn again" in written
    assert "lam was computed for 8 of 10 cases of faults that an effect models; the others are in no rate" in written
    low, high = Rate(hits=1, of=4).bounds
    assert f"| 25.0% | 1 of 4 | {low:.1%} to {high:.1%} | >= 92 % |" in written
    assert "No case is kept." in written
