"""The fit of one candidate beside those a model has."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.causes.candidate_fit import Candidate, finish, fit_candidate, jacobian_at_zero
from rotorrig.identify.causes.score_test import scores
from rotorrig.identify.causes.selection_step import _finish_near, _finish_rivals
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import Stop
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response


@pytest.mark.parametrize(
    "label", ["unbalance_plane, at 160 mm", "coupling", "skew_stiffness", "delay, probe 2y", "shaft_asymmetry", "bow"]
)
def test_at_zero_amplitude_all_columns_but_a_candidates_own_are_those_of_the_fit_without_it(
    short: OrderTrackedResponse, hidden: np.ndarray, label: str
) -> None:
    problem, effect = ExtendedProblem(ExtendedModel([Recording(short)])), find(short.rig, label)
    before = problem.solve(problem.parameters.start(hidden), max_steps=3)
    larger = problem.extended([effect])
    start = np.append(before.p, [q.at_zero / q.size for q in effect.parameters])
    got, want = jacobian_at_zero(larger, before, start), larger.jacobian(start)
    assert got is not None
    assert got.shape == want.shape
    by_difference = [effect.scales_base and name.startswith("position") for name in larger.parameters.names]
    within = np.where(by_difference, 0.1, 2e-3)  # of steps of 10 um, which are the less exact ones
    assert (np.linalg.norm(got - want, axis=0) <= within * np.linalg.norm(want, axis=0)).all()


def test_beyond_bounds_or_without_the_jacobian_of_the_fit_none_is_known(
    short: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem, effect = ExtendedProblem(ExtendedModel([Recording(short)])), find(short.rig, "hysteresis")
    before = problem.solve(problem.parameters.start(hidden), max_steps=1)
    larger = problem.extended([effect])
    start = np.append(before.p, [q.at_zero / q.size for q in effect.parameters])
    assert jacobian_at_zero(larger, before, larger.bounds[1] + 1.0) is None
    kept_none = type(before)(
        p=before.p, covariance=before.covariance, jacobian=np.zeros((0, 0)), chi2=before.chi2, dof=before.dof
    )
    assert jacobian_at_zero(larger, kept_none, start) is None


@pytest.mark.campaign
def test_what_was_given_up_near_the_best_is_fitted_to_the_end_that_it_would_have_had(
    rig: RigConfig, hidden: np.ndarray
) -> None:
    effect = find(rig, "delay, probe 2y")
    response = swept_response(rig, hidden=[(effect, {q.name: 1.5 * q.size for q in effect.parameters})])
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    before = problem.solve(problem.parameters.start(hidden))
    (score,) = scores(problem, before.p, [effect])
    whole = fit_candidate(problem, before, None, score, leader=-np.inf)
    left = fit_candidate(problem, before, None, score, leader=5 * score.lam)
    assert whole is not None and left is not None
    assert left.polished.stop is Stop.GIVEN_UP
    assert whole.polished.stop is Stop.CONVERGED
    far = replace(left, lam=0.4 * whole.lam)
    same, done, still = _finish_rivals([whole, left, far])
    assert same is whole and still is far
    assert done.polished.stop is Stop.CONVERGED
    assert done.polished.chi2 == pytest.approx(whole.polished.chi2, abs=1.0)
    assert done.lam == pytest.approx(before.chi2 - done.polished.chi2)
    assert done.evidence - done.lam == pytest.approx(whole.evidence - whole.lam)


def test_what_came_to_the_end_of_its_steps_near_the_best_is_fitted_to_its_end(
    rig: RigConfig, hidden: np.ndarray
) -> None:
    """An unbalance elsewhere: beside that at the disk, place and size make up for each other."""
    effect = find(rig, "unbalance_plane, at 400 mm")
    response = swept_response(rig, hidden=[(effect, {"unbalance re": 8e-6, "unbalance im": 3e-6, "shift": 0.012})])
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    before = problem.solve(problem.parameters.start(hidden))
    (score,) = scores(problem, before.p, [effect])
    whole = fit_candidate(problem, before, None, score, leader=-np.inf)
    assert whole is not None
    whole = finish(whole)
    assert whole.polished.stop is Stop.CONVERGED
    larger = whole.problem
    short = larger.solve(np.append(before.p, np.zeros(3)), max_steps=8)
    assert short.stop is Stop.BUDGET
    lam = before.chi2 - short.chi2
    near = replace(whole, polished=short, lam=lam, evidence=whole.evidence - 40.0)
    far = replace(near, evidence=whole.evidence - 50.0)
    same, done, still = _finish_near([whole, near, far], SELECTION.settled)
    assert same is whole and still is far
    assert done.polished.chi2 == pytest.approx(whole.polished.chi2, abs=1.0)
    assert done.lam == pytest.approx(before.chi2 - done.polished.chi2)
    ended = replace(near, polished=replace(short, stop=Stop.CONVERGED))  # as near as was asked for
    assert _finish_near([whole, ended], SELECTION.settled)[1] is ended
    _, done = _finish_near([whole, ended], 5.0)
    assert done.polished.chi2 == pytest.approx(whole.polished.chi2, abs=1.0)
    poor = replace(whole, polished=replace(whole.polished, chi2=3.0 * whole.polished.dof))
    assert _finish_near([poor, ended], 5.0)[1] is ended  # the order does not matter


def test_a_candidate_without_a_bounded_motion_further_on_stays_as_it_is(
    short: OrderTrackedResponse, hidden: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(short)], [find(short.rig, "bow")]))
    begun = problem.solve(problem.parameters.start(hidden), max_steps=1)
    left = Candidate(problem=problem, polished=begun, lam=1.0, evidence=1.0)
    for error in (DataError("no motion"), np.linalg.LinAlgError("SVD did not converge")):

        def fail(*_: object, error: Exception = error, **__: object) -> None:
            raise error

        monkeypatch.setattr(ExtendedProblem, "solve", fail)
        assert finish(left) is left
