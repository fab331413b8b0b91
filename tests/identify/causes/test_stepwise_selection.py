"""Which causes the data call for: the one that is hidden, and none where none is."""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.causes.candidate_fit import Candidate, plausible
from rotorrig.identify.causes.selection_step import SelectionStep, try_candidates
from rotorrig.identify.causes.settings import SELECTION
from rotorrig.identify.causes.stepwise_selection import (
    Selection,
    _find_lower_base,
    _search_again,
    is_significant,
    select,
)
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import Stop
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, find
from tests.identify.swept import swept_response
from tests.parameters import defer_rest

TRIED = (
    "bow",
    "unbalance_plane, at 160 mm",
    "delay, probe 2y",
    "skew_stiffness",
    "stiffness_over_speed",
    "coupling",
    "runout, plane 2, twice per turn",
)
Theta = dict[str, float]


def selected(
    response: OrderTrackedResponse, hidden: NDArray[np.float64], labels: tuple[str, ...] = TRIED, *, wrong: bool = True
) -> Selection:
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    base = problem.solve(problem.parameters.start(hidden))
    return select(problem, base, [find(response.rig, label) for label in labels], wrong=wrong)


def effect_of(rig: RigConfig, label: str, share: float = 1.0) -> tuple[Effect, Theta]:
    effect = find(rig, label)
    return effect, {q.name: q.at_zero + share * q.size for q in effect.parameters}


@pytest.mark.parametrize(
    "label", defer_rest(["unbalance_plane, at 160 mm", "delay, probe 2y", "skew_stiffness", "coupling"])
)
def test_the_hidden_effect_is_taken_up_and_nothing_else(
    rig: RigConfig, hidden: NDArray[np.float64], label: str
) -> None:
    effect, theta = effect_of(rig, label, 1.5)
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[(effect, theta)])
    found = selected(response, hidden)
    assert [e.name for e in found.problem.effects] == [effect.name]
    own = found.problem.parameters
    sigma = own.of_effect(found.polished.sigma, 0)
    moved = found.problem.effects[0].relocate(own.of_effect(found.polished.p, 0))[0]
    assert moved.label == found.problem.effects[0].label
    for name, value in own.of_effect(found.polished.p, 0).items():
        assert abs(value - theta[name]) < 4 * sigma[name], name  # the place of an unbalance is known to 0.1 m


@pytest.mark.parametrize("wrong", [True, False])
def test_a_healthy_rig_calls_for_nothing(
    healthy: OrderTrackedResponse, hidden: NDArray[np.float64], wrong: bool
) -> None:
    found = selected(healthy, hidden, wrong=wrong)
    assert found.problem is found.start
    assert found.polished is found.base
    assert len(found.steps) == 1


@pytest.mark.campaign
def test_two_causes_are_both_found(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    both = ("skew_stiffness", "coupling")
    made = [effect_of(rig, label, 2.0) for label in both]
    response = swept_response(rig, rng=np.random.default_rng(12), hidden=made)
    found = selected(response, hidden)
    assert {e.label for e in found.problem.effects} == set(both)
    assert found.polished.chi2 < found.base.chi2 - 2 * SELECTION.detected


def test_parts_of_one_cause_are_replaced_by_the_whole(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    whole = effect_of(rig, "probe_angle, plane 1", 2.0)
    response = swept_response(rig, rng=np.random.default_rng(12), hidden=[whole])
    parts = [find(rig, f"probe_angle, probe {name}") for name in ("1x", "1y")]
    problem = ExtendedProblem(ExtendedModel([Recording(response)], parts))
    polished = problem.solve(problem.parameters.start(hidden))

    def search(problem: ExtendedProblem, polished: Solution, among: Sequence[Effect]) -> SelectionStep:
        return try_candidates(problem, polished, among, lambda share: None, wrong=False, first=False)

    steps: list[SelectionStep] = []
    found, fit = _search_again(problem, polished, search, [whole[0], *parts], steps, kept=0)
    assert [e.label for e in found.effects] == ["probe_angle, plane 1"]
    assert fit.chi2 == pytest.approx(polished.chi2, abs=10)
    assert steps[-1].tried[0].effect is found.effects[0]


def test_a_base_that_was_left_in_a_poor_minimum_is_returned_from_a_better_one(
    rig: RigConfig, hidden: NDArray[np.float64], healthy: OrderTrackedResponse, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever leads out of it looks like a cause, here a probe that sits right."""
    problem = ExtendedProblem(ExtendedModel([Recording(healthy)]))
    right = problem.solve(problem.parameters.start(hidden))
    poor = replace(right, p=right.p + 0.05, chi2=right.chi2 + 1000.0)
    larger = problem.extended([find(rig, "probe_angle, plane 1")])
    fit = larger.solve(np.append(right.p, 0.0))
    turned = Candidate(problem=larger, polished=fit, lam=poor.chi2 - fit.chi2, evidence=poor.chi2 - fit.chi2 - 6.0)
    tried = SelectionStep(before=poor, scores=(), tried=(turned,))
    monkeypatch.setattr("rotorrig.identify.causes.stepwise_selection.try_candidates", lambda *_, **__: tried)
    found = select(problem, poor, list(larger.effects), wrong=True)
    assert (found.steps, found.problem) == ((), problem)
    assert found.base.chi2 == pytest.approx(right.chi2, abs=1.0)


def test_what_a_law_may_be_wrong_by_widens_what_is_found_beside_it(
    rig: RigConfig, hidden: NDArray[np.float64], monkeypatch: pytest.MonkeyPatch
) -> None:
    effect = find(rig, "cubic_spring")
    response = swept_response(rig, rng=np.random.default_rng(3), hidden=[(effect, {"k3": 4e10})])
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    base = problem.solve(problem.parameters.start(hidden))
    bent = problem.extended([effect])
    fit = bent.solve(np.append(bent.parameters.start(hidden)[:-1], 4e10 / effect.parameters[0].size))
    none = Selection(start=problem, base=base, steps=(), problem=problem, polished=base)
    found = replace(none, problem=bent, polished=fit)
    assert none.with_law_error() is none
    after = found.with_law_error()
    sought = bent.parameters.base.sought
    assert (after.polished.sigma[sought] > fit.sigma[sought]).all()
    assert after.polished.p[-1] == pytest.approx(fit.p[-1], abs=3 * after.polished.sigma[-1])

    def fail(*_: object, **__: object) -> Solution:
        raise DataError("law: its force is not found")

    monkeypatch.setattr("rotorrig.identify.causes.stepwise_selection.refit", fail)
    assert found.with_law_error() is found


def test_a_second_cause_has_to_explain_more_than_an_error_of_the_first_ones_model(
    rig: RigConfig, hidden: NDArray[np.float64]
) -> None:
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[effect_of(rig, "skew_stiffness", 1.5)])
    best = selected(response, hidden, ("skew_stiffness",)).steps[0].tried[0]
    just = (best.lam - SELECTION.detected) / SELECTION.model_error**2
    assert is_significant(best, explained=0.99 * just)
    assert not is_significant(best, explained=1.01 * just)


@pytest.mark.campaign
@pytest.mark.parametrize("begun", defer_rest(["at 440 mm", "at 520 mm"]))
def test_an_unbalance_is_named_by_where_it_is_not_by_where_its_fit_began(
    rig: RigConfig, hidden: NDArray[np.float64], begun: str
) -> None:
    effect = find(rig, "unbalance_plane, at 400 mm")
    theta = {"unbalance re": 8e-6, "unbalance im": 3e-6, "shift": 0.012}
    response = swept_response(rig, hidden=[(effect, theta)])
    found = selected(response, hidden, (f"unbalance_plane, {begun}",))
    assert [e.label for e in found.problem.effects] == ["unbalance_plane, at 400 mm"]
    assert found.steps[0].tried[0].effect is found.problem.effects[0]
    names = found.problem.parameters
    sigma = names.of_effect(found.polished.sigma, 0)
    for name, value in names.of_effect(found.polished.p, 0).items():
        assert abs(value - theta[name]) < 0.3 * sigma[name], name


@pytest.mark.campaign
def test_without_the_hidden_effect_the_fit_does_not_get_as_good(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    """A control: what is named above is named for its own sake."""
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[effect_of(rig, "delay, probe 2y", 1.5)])
    rest = tuple(label for label in TRIED if label != "delay, probe 2y")
    with_it, without = selected(response, hidden), selected(response, hidden, rest)
    assert "delay" not in {e.name for e in without.problem.effects}
    assert without.polished.chi2 > with_it.polished.chi2 + SELECTION.detected


@pytest.mark.campaign
def test_evidence_is_the_fall_of_chi2_less_the_same_for_every_unknown(
    rig: RigConfig, hidden: NDArray[np.float64]
) -> None:
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[effect_of(rig, "coupling")])
    (first, *_) = selected(response, hidden).steps
    costs = [(tried.lam - tried.evidence) / len(tried.effect.parameters) for tried in first.tried]
    assert costs == pytest.approx([costs[0]] * len(costs))
    assert 2 < costs[0] <= np.log(first.tried[0].problem.size)
    for tried in first.tried:
        assert tried.lam == pytest.approx(first.before.chi2 - tried.polished.chi2)
        assert is_significant(tried) == (tried.evidence > SELECTION.enough and tried.lam > SELECTION.detected)


@pytest.mark.campaign
def test_a_rival_that_is_not_fitted_or_given_up_is_far_behind_the_named_cause(
    rig: RigConfig, hidden: NDArray[np.float64]
) -> None:
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[effect_of(rig, "delay, probe 2y", 6.0)])
    found = selected(response, hidden)
    (step, *_) = found.steps
    best, *others = step.tried
    assert best.polished.stop is Stop.CONVERGED
    tried = {best.effect.label} | {c.effect.label for c in others if c.polished.stop is not Stop.GIVEN_UP}
    left = [score.effect for score in step.scores if score.effect.label not in tried]
    assert left
    for effect in left:
        problem = found.start.extended([effect])
        to_the_end = problem.solve(problem.parameters.start(step.before.p), tolerance=0.1)
        assert best.lam - (step.before.chi2 - to_the_end.chi2) > SELECTION.near


@pytest.mark.campaign
def test_a_cause_of_a_size_no_rig_has_is_not_plausible(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    effect, theta = effect_of(rig, "unbalance_plane, at 160 mm")
    q = effect.parameters[0]
    for share, expected in ((0.9, True), (4.0, False)):  # its place is not known well, so its size is not
        made = [(effect, dict.fromkeys(theta, share * q.high / np.sqrt(2)))]  # of a phasor, by its magnitude
        response = swept_response(rig, rng=np.random.default_rng(13), hidden=made)
        tried = selected(response, hidden, (effect.label,)).steps[0].tried
        assert [plausible(candidate) for candidate in tried] == [expected]


@pytest.mark.parametrize(
    ("scan", "lam", "expected"), [((), 20.0, True), (((0.0, 1.0),), 20.0, False), (((0.0, 1.0),), 30.0, True)]
)
def test_what_was_looked_for_at_many_moments_has_to_explain_more(
    scan: tuple[tuple[float, ...], ...], lam: float, expected: bool
) -> None:
    recording = SimpleNamespace(rows=np.arange(8 * 50))  # 2 ln 50 = 7.8
    problem, effect = SimpleNamespace(recordings=[recording]), SimpleNamespace(grid=scan)
    candidate = SimpleNamespace(evidence=10.0, lam=lam, problem=problem, effect=effect)
    assert is_significant(cast(Candidate, candidate)) is expected


def test_nothing_to_try_selects_nothing(healthy: OrderTrackedResponse, hidden: NDArray[np.float64]) -> None:
    found = selected(healthy, hidden, ())
    assert found.problem is found.start
    assert found.steps[0].tried == ()


def test_progress_only_grows_within_each_cause(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    response = swept_response(rig, rng=np.random.default_rng(11), hidden=[effect_of(rig, "skew_stiffness")])
    problem = ExtendedProblem(ExtendedModel([Recording(response)]))
    base = problem.solve(problem.parameters.start(hidden))
    told: dict[str, list[float]] = {}
    select(
        problem,
        base,
        [find(rig, "skew_stiffness"), find(rig, "bow")],
        wrong=True,
        progress=lambda stage, share: told.setdefault(stage, []).append(share),
    )
    assert "cause 1" in told
    for shares in told.values():
        assert shares == sorted(shares)
        assert 0 <= shares[0] <= shares[-1] <= 1


@pytest.mark.parametrize(
    ("with_cause", "without", "anew"),
    [
        (110.0, 120.0, True),  # the cause explained what a poor minimum had left
        (5000.0, 6000.0, True),  # it explains the rest no better than another may
        (5000.0, 7600.0, False),  # it explains more than the base by itself
        (110.0, 6000.0, False),  # it is what is there
        (110.0, 9990.0, False),
        (9980.0, 9990.0, False),  # no lower than the base, but for what chance would do
        (9970.0, 9980.0, True),
    ],
)
def test_a_search_begins_anew_from_a_lower_base_unless_it_is_the_cause_that_explains(
    with_cause: float, without: float, anew: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fit(chi2: float) -> Solution:
        return cast(Solution, SimpleNamespace(chi2=chi2, dof=100))

    best = cast(Candidate, SimpleNamespace(problem=None, polished=fit(with_cause), effect=None))
    lower = fit(without)
    monkeypatch.setattr("rotorrig.identify.causes.stepwise_selection.leave_out", lambda *_: (None, lower))
    assert (_find_lower_base(fit(10000.0), best) is lower) == anew


@pytest.mark.parametrize(("without", "anew"), [(3_486_935.0, False), (3_158_500.0, True)])
def test_a_search_does_not_begin_anew_from_a_poor_base_no_lower_than_its_fit_had_left_open(
    without: float, anew: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A slipping coupling's base ended at 3,487,778: 843 less is no other minimum, and cost 131 s."""

    def fit(chi2: float) -> Solution:
        return cast(Solution, SimpleNamespace(chi2=chi2, dof=6000))

    best = cast(Candidate, SimpleNamespace(problem=None, polished=fit(2.9e6), effect=None))
    lower = fit(without)
    monkeypatch.setattr("rotorrig.identify.causes.stepwise_selection.leave_out", lambda *_: (None, lower))
    assert (_find_lower_base(fit(3_487_778.0), best) is lower) == anew
