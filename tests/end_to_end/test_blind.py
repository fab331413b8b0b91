"""A small blind benchmark: faults in simulated rigs, at sizes that can be named, are found by what they are.

The rig has one plane of probes and is swept three times as fast as in the benchmark ("fast"). The sizes in `LARGE` are
at three times what can be told from the nearest rival (lam to it 9 * 16 or more, by parts/blind/lam.py) or more;
with fixed seeds all of them must be right. Those in `ALIKE` are easily seen, but one plane of probes cannot tell them
from a rival (lam below 16): the right answer is a tie of the two. The fresh rigs have been seen by nobody: the date
draws them, and which of the large faults they hide; it is printed on failure, and as many must be right as the stated
rate leaves in all but one of 1000 days.
"""

import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from benchmarks.parts.blind.case_run import diagnosed, right_answers, verdict_part
from benchmarks.parts.blind.cases import Case, draw_again, sizes
from benchmarks.parts.blind.measured import MOST_TRIPS, measure
from benchmarks.parts.blind.names import effect_of
from benchmarks.parts.blind.score import Score, score
from benchmarks.parts.parallel import in_parallel
from rotorrig.rig.errors import LimitExceeded
from rotorrig.sims.effects.base import catalogue
from rotorrig.sims.plant.sealed_truth import unseal
from rotorrig.sims.plant.truth import FaultSpec

Sizes = Mapping[str, Mapping[str, float]]

pytestmark = [
    pytest.mark.campaign,
    pytest.mark.xfail(reason="sizes are those of the earlier simulated rig, whose laws were the effects' own"),
]

LARGE: Sizes = {  # lam to the base, and to the nearest rival
    "bow": {"amount": 6e-5},  # 416, 174 to runout
    "coupling": {"bore_force": 0.3, "stiffness_variation": 3000.0},  # 2.2e6, more than 200
    "cross_stiffness": {"stiffness": 2500.0},  # 3.9e3, more than 200
    "delay": {"time": 3e-4},  # 7.3e3, more than 200
    "drag": {"coefficient": 60.0},  # 7.4e3, more than 200
    "internal_damping": {"time": 2e-4},  # 899, 145 to skew_stiffness
    "pedestal": {"compliance": 4e-6},  # 3.2e5, more than 200
    "skew_stiffness": {"stiffness": 1500.0},  # 2.7e3, more than 200
    "stiffness_over_speed": {"gain": 0.1},  # 1.3e3, more than 200
}
ALIKE: Sizes = {
    "couple": {"skew": 2e-3},  # 4.3e3, 3.4 to unbalance_plane
    "probe_angle": {"turn": 0.25},  # 109, 7.4 to cross_talk; 26 to the other probe, so the place is not asked for
}
RIVALS = {"couple": "unbalance_plane", "probe_angle": "cross_talk"}
ALL = {**LARGE, **ALIKE}
TODAY = int(f"{datetime.now(UTC):%Y%m%d}")
FIXED = {fault: Case(design="fast", faults=(fault,), seed=1) for fault in ALL}
FRESH = tuple(
    Case(design="fast", faults=(str(fault),), seed=TODAY)
    for fault in np.random.default_rng(TODAY).choice(list(LARGE), 3, replace=False)
)
HEALTHY = tuple(Case(design="fast", seed=TODAY + i) for i in range(2))
CONTROL = FIXED["cross_stiffness"]
NEIGHBOURS = {"skew_stiffness", "probe_angle", "stiffness_over_speed"}  # all that the control may be taken for
RATE, ALARMS = 0.92, 0.02  # stated: ranked first, and false alarms
ONCE = 1e-3


@dataclass(frozen=True)
class Results:
    """The scores of all cases, and of the control diagnosed without its effect."""

    scores: dict[Case, Score]
    control: Score

    def told(self, case: Case) -> str:
        """Say what became of a case."""
        found = self.scores[case]
        return f"{case.name}: {found.verdict}, {found.first or 'no cause'} first, {sorted(found.named)} named"


@pytest.fixture(scope="module")
def results() -> Results:
    """Measure and diagnose all cases, two at a time."""
    others = {effect.name for effect in catalogue(CONTROL.rig)} - NEIGHBOURS
    cases = (*FIXED.values(), *FRESH, *HEALTHY)
    jobs = [(case, ()) for case in cases] + [(CONTROL, tuple(others))]
    *found, control = in_parallel(judged, jobs, workers=2)
    return Results(scores=dict(zip(cases, found, strict=True)), control=control)


def judged(job: tuple[Case, tuple[str, ...]]) -> Score:
    """Measure a case and diagnose it without some effects of the library; the truth is opened after that.

    One whose sweep trips is drawn again.
    """
    case, without = job
    for _ in range(MOST_TRIPS):
        try:
            return diagnosed_case(case, without)
        except LimitExceeded:
            case = draw_again(case)
    raise AssertionError(f"{case.name}: trips however it is drawn")


def diagnosed_case(case: Case, without: tuple[str, ...]) -> Score:
    """Measure and diagnose it as it is drawn."""
    faults = tuple(FaultSpec(name=f.name, parameters={**f.parameters, **ALL[f.name]}) for f in sizes(case))
    with tempfile.TemporaryDirectory() as folder:
        sealed = Path(folder) / "sealed.json"
        responses = measure(case, sealed=sealed, folder=Path(folder), faults=faults)
        found = diagnosed(responses, Path(folder) / "diagnosis.json", without=without)
        hidden = [asdict(each) for each in right_answers(case, unseal(sealed))]
        return score({**asdict(case), **verdict_part(found), "seconds": 0.0, "seconds_cpu": 0.0, "hidden": hidden})


@pytest.mark.parametrize("fault", LARGE)
def test_a_fault_well_above_what_can_be_named_is_named(results: Results, fault: str) -> None:
    found = results.scores[FIXED[fault]]
    assert found.top1, results.told(FIXED[fault])
    assert found.in_set


@pytest.mark.parametrize("fault", ALIKE)
def test_a_fault_that_looks_like_another_is_tied_with_it(results: Results, fault: str) -> None:
    found = results.scores[FIXED[fault]]
    assert found.verdict == "tied", results.told(FIXED[fault])
    assert {effect_of(label) for label in found.named} >= {fault, RIVALS[fault]}, results.told(FIXED[fault])


def test_rigs_that_nobody_has_seen_are_named_as_often_as_stated(results: Results) -> None:
    right = [results.scores[case].top1 for case in FRESH]
    least = int(binom.ppf(ONCE, len(FRESH), RATE))
    assert sum(right) >= least, f"seed {TODAY}: {[results.told(case) for case in FRESH]}"


def test_healthy_rigs_that_nobody_has_seen_raise_no_more_alarms_than_stated(results: Results) -> None:
    alarms = [results.told(case) for case in HEALTHY if results.scores[case].detected]
    most = int(binom.isf(ONCE, len(HEALTHY), ALARMS))
    assert len(alarms) <= most, f"seed {TODAY}: {alarms}"


def test_without_the_true_effect_in_the_library_the_fault_is_not_named(results: Results) -> None:
    assert not results.control.top1
    assert not results.control.in_set
    assert results.control.detected, "the model is wrong all the same"
