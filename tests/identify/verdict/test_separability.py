"""How far apart two causes are: nothing for a cause and itself, and linear algebra for a small one and none."""

import numpy as np
import pytest

from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.separability import fit_from_starts, separability
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from tests.identify.swept import U, swept_response

FAST = {"speeds": (700.0, 2600.0), "ramp": 400.0}


@pytest.fixture(scope="module")
def fast(rig: RigConfig) -> OrderTrackedResponse:
    return swept_response(rig, **FAST)


def with_cause(
    fast: OrderTrackedResponse, hidden: np.ndarray, label: str, amount: float
) -> tuple[ExtendedProblem, np.ndarray]:
    """A problem with that effect, and its unknowns with the first of the effect at `amount` sizes."""
    problem = ExtendedProblem(ExtendedModel([Recording(fast)], [find(fast.rig, label)]))
    p = problem.parameters.start(hidden)
    p[problem.parameters.base.unbalance] = U.real, U.imag
    p[problem.parameters.own.start] += amount
    base = problem.parameters.base
    p[base.hubs], p[base.tilts] = 0.3, 60.0  # so that what is never below zero may go either way
    return problem, p


@pytest.mark.parametrize("label", ["unbalance_plane, at 160 mm", "delay", "skew_stiffness"])
def test_a_cause_is_no_distance_from_itself(fast: OrderTrackedResponse, hidden: np.ndarray, label: str) -> None:
    problem, p = with_cause(fast, hidden, label, 1.0)
    assert separability(problem, p, problem.effects) < 0.1


@pytest.mark.parametrize("label", ["unbalance_plane, at 160 mm", "delay, probe 2y", "skew_stiffness"])
def test_a_small_cause_is_as_far_from_none_as_its_column_is_from_those_of_the_base(
    fast: OrderTrackedResponse, hidden: np.ndarray, label: str
) -> None:
    amount = 0.1
    problem, p = with_cause(fast, hidden, label, amount)
    names = problem.parameters
    J = problem.jacobian(p)
    base, change = J[:, : names.own.start], amount * J[:, names.own.start]
    left = change - base @ np.linalg.lstsq(base, change, rcond=None)[0]
    # a fit ends within 0.3, and what a hub or a tilt stiffness does is not linear
    assert separability(problem, p, []) == pytest.approx(left @ left, rel=0.05, abs=1.0)


def test_a_bow_shows_more_when_a_second_plane_sees_it(rig: RigConfig, one_plane: RigConfig, hidden: np.ndarray) -> None:
    """Runout of one plane can stand for a bow there; two planes see the bow's shape."""
    lam = []
    for seen in (one_plane, rig):
        problem, p = with_cause(swept_response(seen, speeds=(480, 1500), ramp=400), np.zeros(0), "bow", 3.0)
        p[problem.parameters.base.sought] = hidden[problem.parameters.base.sought]
        lam.append(separability(problem, p, [find(seen, "runout, plane 1")]))
    assert lam[0] < VERDICT.nameable
    assert lam[1] > 2 * lam[0]


def test_nothing_measured_has_a_say(rig: RigConfig, fast: OrderTrackedResponse, hidden: np.ndarray) -> None:
    noisy = swept_response(rig, rng=np.random.default_rng(8), **FAST)
    lam = []
    for response in (fast, noisy):
        problem, p = with_cause(response, hidden, "unbalance_plane, at 160 mm", 0.5)
        lam.append(separability(problem, p, []))
    # but through the share of the readings that the covariance holds
    assert lam[0] == pytest.approx(lam[1], rel=0.02)


def test_of_several_starts_the_best_is_taken(fast: OrderTrackedResponse, hidden: np.ndarray) -> None:
    """A pedestal's resonance is found from the start next to it."""
    pedestal = find(fast.rig, "pedestal, x")
    problem = ExtendedProblem(ExtendedModel([Recording(fast)], [pedestal]))
    p = problem.parameters.start(hidden)
    p[problem.parameters.base.unbalance] = U.real, U.imag
    sizes = [q.size for q in pedestal.parameters]
    p[problem.parameters.own] = np.array([0.1, 34 * 2 * np.pi, 0.03, 0.1]) / sizes
    (predicted,) = problem.model.predict(p)
    there = ExtendedProblem(ExtendedModel([problem.recordings[0].instead(predicted)], [pedestal]))
    found = fit_from_starts(there, there.parameters.start(hidden)[: there.parameters.own.start])
    assert found.p[-3] * sizes[1] == pytest.approx(34 * 2 * np.pi, rel=0.02)


def test_how_far_beyond_enough_a_cause_is_is_not_found_out(fast: OrderTrackedResponse, hidden: np.ndarray) -> None:
    problem, p = with_cause(fast, hidden, "skew_stiffness", 1.0)
    rival = [find(fast.rig, "delay")]
    whole = separability(problem, p, rival)
    assert separability(problem, p, rival, enough=2 * whole) == pytest.approx(whole, rel=0.01)
    assert separability(problem, p, rival, enough=whole / 10) > whole / 10
