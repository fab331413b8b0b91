"""What is counted of discoveries, what the right answers are, and one case from its truth to its line."""

import json
import zlib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from benchmarks.discovery import KEPT, RECORDINGS, SEEDS, summarise
from benchmarks.parts.blind.cases import Case
from benchmarks.parts.discovery.case_run import run_case
from benchmarks.parts.discovery.expected import FORCES, READINGS, expected
from benchmarks.parts.discovery.wanted import later_outsiders, wanted_cases
from rotorrig.rig.config import load
from rotorrig.sims.effects import LAWS
from rotorrig.sims.plant import FaultSpec
from rotorrig.sims.plant.faults.base import fault_names

RIG = load(Path(__file__).parents[2] / "configs" / "rk4.toml")
FORCE = {"kind": "force", "places": [0.48], "laws": ["resonance"]}
READING = {"kind": "reading", "places": [], "laws": []}


def line(name: str, right: dict[str, Any] | None, *, kind_of: str = "single", **found: Any) -> dict[str, Any]:
    usual = {"kind": "force", "laws": ["resonance"], "place": 0.48, "sigma": 0.005, "shortfall": ""}
    errors = {"over_floor": 1.2, "over_expected": 1.0, "seconds_cpu": 30.0}
    own = {"name": name, "kind_of": kind_of, "right": [right], "adequate": False, "ending": "ended", "version": "v"}
    return own | usual | errors | found


def test_places_kinds_and_laws_are_counted_each_of_what_could_have_them() -> None:
    lines = [
        line("a", FORCE),
        line("b", FORCE, place=0.51, sigma=0.01, laws=["damping"]),
        line("c", FORCE, place=0.60, sigma=0.2, shortfall="where it acts is not known", over_floor=1.8),
        line("d", READING, kind="reading", place=None, sigma=None, laws=["share"]),
        line("e", READING, place=0.1),
        {"name": "f", "kind_of": "single", "adequate": True, "right": [FORCE], "ending": "ended", "version": "v"},
        line("g", FORCE, kind_of="outsider", place=0.47),
        line("h", None, kind_of="healthy", shortfall="it leaves 40 % of the misfit"),
        {"name": "i", "kind_of": "healthy", "adequate": True, "ending": "ended", "version": "v"},
    ]
    result = summarise(lines, wanted=12)
    counts = {key: (value["hits"], value["of"]) for key, value in result.items() if isinstance(value, dict)}
    assert counts["kind_right"] == (4, 5)
    assert counts["described"] == (4, 5)
    assert counts["place_right"] == (1, 2)  # of the described with a place: a, b
    assert counts["place_right_of_sure"] == (1, 2)
    assert counts["region_missed"] == (1, 2)
    assert counts["direction_right"] == (1, 2)
    assert counts["heldout_ok"] == (4, 5)
    assert counts["healthy_found"] == (0, 2)
    assert (counts["outsiders_kind_right"], counts["outsiders_place_right"]) == ((1, 1), (1, 1))
    assert (result["cases"], result["wanted"], result["errors"]) == (9, 12, 0)


def test_every_fault_has_an_answer_by_laws_that_exist() -> None:
    faults = set(fault_names())
    assert faults >= {*FORCES, *READINGS}
    # the first turns the rotor and does not bend it, the other is of no order
    assert faults - {*FORCES, *READINGS} == {"drag", "twice_line_pull"}
    assert {law for _, laws in FORCES.values() for law in laws} <= set(LAWS)
    place = expected(RIG, FaultSpec(name="pedestal", parameters={}))
    assert place is not None and place.places == (0.481,)
    assert expected(RIG, FaultSpec(name="unbalance_plane", parameters={"position": 0.3})).places == (0.3,)  # type: ignore[union-attr]
    assert expected(RIG, FaultSpec(name="seal", parameters={"position": 0.2})).places == (0.2,)  # type: ignore[union-attr]
    assert expected(RIG, FaultSpec(name="magnetic_pull", parameters={})).places == (0.2805,)  # type: ignore[union-attr]
    assert expected(RIG, FaultSpec(name="probe_bracket", parameters={})).kind == "reading"  # type: ignore[union-attr]
    assert expected(RIG, FaultSpec(name="drag", parameters={})) is None


def test_faults_for_discoveries_alone_stand_among_the_blind_test_s_cases_whose_order_stays() -> None:
    """Their order has the length and checksum of the list without the others; what is kept is in it."""
    wanted = wanted_cases(seeds=SEEDS, first=2000)
    own = [case.name for case in wanted if not set(case.faults) & set(later_outsiders())]
    assert (len(own), zlib.crc32("\n".join(own).encode())) == (400, 239753383)
    assert {json.loads(text)["name"] for text in KEPT.read_text(encoding="utf-8").splitlines()} <= set(own)
    later = [case for case in wanted if case.name not in own]
    assert Counter(case.faults[0] for case in later) == dict.fromkeys(later_outsiders(), 8)
    assert {case.kind for case in later} == {"outsider"}
    half = wanted[: len(wanted) // 2]
    assert sum(case in half for case in later) == pytest.approx(len(later) / 2, abs=1)


def test_what_is_asked_for_alone_comes_alone() -> None:
    asked = wanted_cases(seeds=2, first=0, hidden=["seal", "bow"])
    assert sorted(case.name for case in asked) == ["bow-0", "bow-1", "seal-0", "seal-1"]
    assert [case.name for case in wanted_cases(seeds=1, first=0, hidden=["snubber"])] == ["snubber-0"]


@pytest.mark.campaign
def test_a_pedestal_of_the_plant_is_found_at_its_bearing() -> None:
    """The plant's pedestal is a mass on springs in its own equations; no effect of the library is tried."""
    case = Case(design="P2", faults=("pedestal",), seed=0)
    found = {key: value for part in run_case((case, RECORDINGS)) for key, value in part.items()}
    assert "error" not in found, found
    json.dumps(found)
    true = found["faults"][0]["parameters"]["frequency"]
    assert found["laws"][0] == "resonance"
    assert found["place"] == pytest.approx(0.481, abs=0.025)
    assert f"{true:.0f}" in found["words"].split("resonates at ")[1].split(" Hz")[0]
    assert found["over_expected"] < 1.5
    assert found["over_expected"] < found["before_over_expected"]
