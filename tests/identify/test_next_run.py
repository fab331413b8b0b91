"""The run that is proposed for tied causes does tell them apart."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.next_run import cheapest
from rotorrig.identify.planned import plans
from rotorrig.identify.recording import Recording
from rotorrig.identify.selection import Selection, select
from rotorrig.identify.separation import NAMEABLE, separation
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.description import RigConfig
from rotorrig.rig.units import RPM
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response

BOW = {"bow re": 22e-6, "bow im": 0.0}
LABELS = ("bow", "runout, plane 1")


def selected(response: OrderTrackedResponse, hidden: NDArray[np.float64]) -> Selection:
    problem = ExtendedProblem([Recording(response)])
    start = problem.parameters.start(np.zeros(0))
    start[problem.parameters.base.sought] = hidden[problem.parameters.base.sought]
    base = problem.solve(problem.settled(start, np.arange(len(start))))
    return select(problem, base, [find(response.rig, label) for label in LABELS], wrong=True)


@pytest.fixture(scope="module")
def tied(one_plane: RigConfig, hidden: NDArray[np.float64]) -> Selection:
    bow = (find(one_plane, "bow"), BOW)
    low = swept_response(one_plane, rng=np.random.default_rng(3), hidden=[bow], speeds=(480, 1500))
    return selected(low, hidden)


def test_the_causes_are_told_apart_by_the_run_that_is_proposed(tied: Selection, hidden: NDArray[np.float64]) -> None:
    found = cheapest(tied)
    response = tied.problem.recordings[0].response
    plan = next(plan for plan in plans(response) if found["words"].startswith(plan.words))
    assert set(found["separates"]) == set(LABELS)
    assert found["kind"] == plan.kind
    assert found["lam"] >= NAMEABLE
    assert not plan.trial, "one run will do"
    made = swept_response(
        plan.rig,
        rng=np.random.default_rng(4),
        hidden=[(find(plan.rig, "bow"), BOW)],
        speeds=(plan.low * RPM, plan.high * RPM),
        ramp=plan.ramp * RPM,
    )
    (first, *_) = selected(made, hidden).stages
    by_label = {candidate.effect.label: candidate.evidence for candidate in first.tried}
    assert by_label["bow"] > by_label.get("runout, plane 1", -np.inf) + NAMEABLE / 2


def test_before_that_run_they_were_not(tied: Selection) -> None:
    best, rival = tied.stages[0].tried
    assert best.evidence - rival.evidence < NAMEABLE
    assert separation(best.problem, best.polished.p, rival.problem.effects) < NAMEABLE


def test_nothing_is_proposed_where_nothing_is_tied(healthy: OrderTrackedResponse, hidden: NDArray[np.float64]) -> None:
    assert cheapest(selected(healthy, hidden)) == {}
