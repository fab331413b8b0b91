"""The first look at every cause, against full fits."""

import numpy as np
import pytest

from rotorrig.identify.causes.candidates import candidates
from rotorrig.identify.causes.score_jacobian import score_columns
from rotorrig.identify.causes.score_test import scores
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.parameters import ExtendedParameters
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response
from tests.parameters import defer_rest

FAST = {"speeds": (700.0, 2600.0), "ramp": 400.0}


def fitted(problem: ExtendedProblem, hidden: np.ndarray) -> Solution:
    return problem.solve(problem.parameters.start(hidden), tolerance=1e-6)


@pytest.mark.parametrize(
    "label",
    defer_rest(
        ["unbalance_plane, at 160 mm", "delay", "runout, plane 2, twice per turn", "coupling", "skew_stiffness"], now=2
    ),
)
def test_a_score_is_how_far_chi2_falls_when_the_effect_is_fitted(
    rig: RigConfig, hidden: np.ndarray, label: str
) -> None:
    effect = find(rig, label)
    little = {q.name: 0.1 * q.size for q in effect.parameters}
    response = swept_response(rig, rng=np.random.default_rng(4), hidden=[(effect, little)], **FAST)
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    base = fitted(problem, hidden)
    (score,) = scores(problem, base.p, [effect])
    larger = problem.extended([effect])
    full = larger.solve(larger.parameters.start(base.p), tolerance=1e-6)
    # to 1: the score lets what is never below zero, as a hub's stiffness, go there too
    assert score.lam == pytest.approx(base.chi2 - full.chi2, rel=0.03, abs=1.0)


def test_the_hidden_effect_scores_best(rig: RigConfig, hidden: np.ndarray) -> None:
    effect = find(rig, "skew_stiffness")
    theta = {q.name: 0.3 * q.size for q in effect.parameters}
    response = swept_response(rig, rng=np.random.default_rng(5), hidden=[(effect, theta)], **FAST)
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    base = fitted(problem, hidden)
    found = scores(problem, base.p, candidates(problem.recordings))
    assert found[0].effect.name == "skew_stiffness"
    assert [s.lam for s in found] == sorted((s.lam for s in found), reverse=True)


def test_what_the_base_can_follow_scores_nothing(rig: RigConfig, hidden: np.ndarray) -> None:
    response = swept_response(rig, rng=np.random.default_rng(6), **FAST)
    problem = ExtendedProblem(ExtendedModel([Recording(response)], [find(rig, "bow")]))
    base = fitted(problem, hidden)
    (score,) = scores(problem, base.p, [find(rig, "bow")])
    assert score.lam == pytest.approx(0.0, abs=1e-3)
    assert score.visible == pytest.approx(0.0, abs=1e-3)


def test_what_shows_grows_with_the_noise_it_is_seen_through(rig: RigConfig, hidden: np.ndarray) -> None:
    """Lambda at the typical size goes with the number of rows: twice as slow a sweep shows about twice as much."""
    visible = []
    for ramp in (400.0, 200.0):
        response = swept_response(rig, speeds=FAST["speeds"], ramp=ramp)
        problem = ExtendedProblem(ExtendedModel([Recording(response)]))
        (score,) = scores(problem, fitted(problem, hidden).p, [find(rig, "unbalance_plane, at 160 mm")])
        assert score.lam < 0.1
        visible.append(score.visible)
    assert 1.5 < visible[1] / visible[0] < 3


def test_the_columns_of_all_candidates_at_once_are_those_of_each_alone(rig: RigConfig, hidden: np.ndarray) -> None:
    """What one sweep for all finds, the jacobian of a problem with that effect alone finds too."""
    recording = Recording(swept_response(rig, orders=(1, 2, 3), speeds=(900, 2600), ramp=600))
    problem = ExtendedProblem(ExtendedModel([recording]))
    p = problem.parameters.start(hidden)
    labels = ["bow", "coupling", "delay, probe 1x", "stiffness_over_speed", "shaft_asymmetry"]
    effects = [find(rig, label) for label in labels]
    for effect, columns in zip(effects, score_columns(problem, p, effects), strict=True):
        alone = problem.extended([effect])
        names: ExtendedParameters = alone.parameters
        own = alone.jacobian(names.start(p), np.arange(names.own.start, names.own.stop))
        tolerance = 3e-3 * np.linalg.norm(own, axis=0).max()
        np.testing.assert_allclose(columns, own, rtol=0, atol=tolerance, err_msg=effect.label)


def test_an_effect_without_a_first_order_has_no_score(rig: RigConfig, hidden: np.ndarray) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(swept_response(rig, orders=(1,), **FAST))]))
    assert not scores(problem, problem.parameters.start(hidden), [find(rig, "cubic_spring")])


def test_an_unknown_that_is_never_less_than_nothing_scores_only_what_more_of_it_explains(
    rig: RigConfig, hidden: np.ndarray
) -> None:
    loss = find(rig, "hysteresis")
    response = swept_response(rig, hidden=[(loss, {"eta": 0.01})], **FAST)
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    p = problem.parameters.start(hidden)
    z = problem.model.predict(p)[0]
    lost = {order: measured.z - z[order] for order, measured in problem.recordings[0].measured.items()}
    for sign, explained in ((1, True), (-1, False)):
        there = ExtendedProblem(
            ExtendedModel([problem.recordings[0].instead({n: z[n] + sign * d for n, d in lost.items()})])
        )
        (score,) = scores(there, p, [loss])
        assert (score.lam > 0) == explained
        assert (score.step[0] > 0) == explained


def test_an_effect_with_several_beginnings_is_scored_once_where_it_suits_best(
    rig: RigConfig, hidden: np.ndarray
) -> None:
    crack = find(rig, "crack")
    mouth = np.radians(97.0)
    hung = [(crack, {"softness": 1e-4, "mouth": mouth, "place": 0.3})]
    response = swept_response(rig, orders=(1, 2, 3), hidden=hung, speeds=(500.0, 1600.0), ramp=300.0)
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    (score,) = scores(problem, problem.parameters.start(hidden), [crack])
    assert score.effect.label == "crack"
    assert score.effect.at_zero["mouth"] == pytest.approx(np.radians(90.0))
    assert score.step[0] > 0
