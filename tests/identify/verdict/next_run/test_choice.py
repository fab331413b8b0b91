"""The run that is proposed for tied causes does tell them apart."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.causes.stepwise_selection import Selection, select
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.nuisance_effects import MarkEdge
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.least_squares.solve import squared_distance
from rotorrig.identify.verdict.next_run.choice import find_next_run, find_other_run
from rotorrig.identify.verdict.next_run.forecast import draw_left_open, share_of_limit
from rotorrig.identify.verdict.next_run.plans import Plan, plans
from rotorrig.identify.verdict.separability import separability
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import Effect, find
from tests.identify.swept import RAMP, U, swept_response

BOW = {"bow re": 22e-6, "bow im": 0.0}
LABELS = ("bow", "runout, plane 1")


def selected(
    response: OrderTrackedResponse,
    hidden: NDArray[np.float64],
    labels: Sequence[str] = LABELS,
    *,
    more: Sequence[Recording] = (),
    nuisances: Sequence[Effect] = (),
) -> Selection:
    problem = ExtendedProblem(ExtendedModel([Recording(response), *more], nuisances))
    start = problem.parameters.start(np.zeros(0))
    start[problem.parameters.base.sought] = hidden[problem.parameters.base.sought]
    base = problem.solve(problem.solve_linear(start, np.arange(len(start))))
    return select(problem, base, [find(response.rig, label) for label in labels], wrong=True)


@pytest.fixture(scope="module")
def tied(one_plane: RigConfig, hidden: NDArray[np.float64]) -> Selection:
    bow = (find(one_plane, "bow"), BOW)
    low = swept_response(one_plane, rng=np.random.default_rng(3), hidden=[bow], speeds=(480, 1500))
    return selected(low, hidden)


def test_the_causes_are_told_apart_by_the_run_that_is_proposed(tied: Selection, hidden: NDArray[np.float64]) -> None:
    found = find_next_run(tied)
    assert found is not None
    response = tied.problem.recordings[0].response
    plan = next(plan for plan in plans(response) if found.words.startswith(plan.words))
    assert set(found.separates) == set(LABELS)
    assert found.kind == plan.kind
    assert found.lam >= VERDICT.nameable
    assert not plan.trial, "one run will do"
    made = swept_response(
        plan.rig,
        rng=np.random.default_rng(4),
        hidden=[(find(plan.rig, "bow"), BOW)],
        speeds=(plan.low * RPM, plan.high * RPM),
        ramp=plan.ramp * RPM,
    )
    (first, *_) = selected(made, hidden).steps
    by_label = {candidate.effect.label: candidate.evidence for candidate in first.tried}
    assert by_label["bow"] > by_label.get("runout, plane 1", -np.inf) + VERDICT.nameable / 2


def test_before_that_run_they_were_not(tied: Selection) -> None:
    best, rival = tied.steps[0].tried
    assert best.evidence - rival.evidence < VERDICT.nameable
    assert separability(best.problem, best.polished.p, rival.problem.effects) < VERDICT.nameable


def test_nothing_is_proposed_where_nothing_is_tied(healthy: OrderTrackedResponse, hidden: NDArray[np.float64]) -> None:
    assert find_next_run(selected(healthy, hidden)) is None


def test_tied_causes_are_never_left_without_a_word(tied: Selection, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> float:
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice._separability", fail)
    found = find_next_run(tied)
    assert found is not None
    assert (found.kind, found.planned) == ("none", False)
    assert found.words.startswith("No next run could be computed: ramp rate: Singular matrix")
    assert found.words.count(".") == 1, "one sentence"
    assert np.isnan(found.lam)
    assert set(found.separates) == set(LABELS)


def test_a_plan_whose_separation_is_no_number_is_not_proposed(tied: Selection, monkeypatch: pytest.MonkeyPatch) -> None:
    rated = iter([np.nan, 5.0, np.nan, *[1.0] * 9])
    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice._separability", lambda *_, **__: next(rated))
    found = find_next_run(tied)
    assert found is not None
    assert (found.lam, found.kind) == (5.0, "through critical"), "the second by its time"


@pytest.mark.parametrize(
    ("rated", "kind", "lam"),
    [
        ({"ramp rate": 3.9, "dwells": 9.0, "trial mass": 15.0}, "dwells", 9.0),  # 6 and 5 a minute; 3.9 is no find
        ({"ramp rate": 3.9, "dwells": 9.0, "trial mass": 90.0}, "trial mass", 90.0),  # which tells them apart
        ({"ramp rate": 17.0, "dwells": 90.0, "trial mass": 90.0}, "ramp rate", 17.0),  # enough in a tenth of the time
        ({"second plane": 90.0}, "second plane", 90.0),
    ],
)
def test_the_quickest_run_that_tells_causes_apart_or_the_one_that_tells_most_per_minute(
    tied: Selection, monkeypatch: pytest.MonkeyPatch, rated: dict[str, float], kind: str, lam: float
) -> None:
    def rate(best: object, rivals: object, plan: Plan) -> tuple[float, str]:
        return rated.get(plan.kind, 0.0), ""

    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice._rate", rate)
    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice.share_of_limit", lambda *_: 0.1)
    found = find_next_run(tied)
    assert found is not None
    assert (found.kind, found.lam) == (kind, lam)
    assert found.minutes > {"second plane": 20.0, "trial mass": 3.0, "dwells": 1.4, "ramp rate": 0.0}[kind]
    assert len(found.speeds) == (4 if kind == "dwells" else 0)


def test_only_what_may_be_proposed_is_forecast(tied: Selection, monkeypatch: pytest.MonkeyPatch) -> None:
    """A forecast of what tells nothing took as long as all fits; one that is too loud gives way to the next."""
    asked: list[str] = []
    rated = {"ramp rate": 3.9, "dwells": 9.0, "trial mass": 90.0}

    def share(problem: object, vectors: object, plan: Plan, limits: object) -> float:
        asked.append(plan.kind)
        return 2.0 if plan.kind == "trial mass" else 0.1

    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice._rate", lambda b, r, p: (rated.get(p.kind, 0.0), ""))
    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice.share_of_limit", share)
    found = find_next_run(tied)
    assert found is not None and (found.kind, found.lam) == ("dwells", 9.0)
    assert set(asked) == {"trial mass", "dwells"}


def test_a_rival_is_followed_no_further_than_the_nearest_before_it(
    tied: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = iter([30.0, 20.0, 25.0])
    asked: list[float] = []
    step = tied.steps[0]
    best, rival = step.tried

    def rate(*_: object, enough: float) -> float:
        asked.append(enough)
        return next(answers)

    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice.separability", rate)
    found = find_next_run(replace(tied, steps=(replace(step, tried=(best, rival, rival, rival)),)))
    assert found is not None
    assert found.lam == 20.0
    assert asked == [np.inf, 30.0, 20.0]


LATE = {"delay": 1e-3}  # s
LATE_OR_TURNED = ("delay, probe 1y", "probe_angle, probe 1y")
BELOW = {"speeds": (480, 2000)}  # rpm: the first critical speeds are at 2226 and 2237


@pytest.fixture(scope="module")
def below_critical(one_plane: RigConfig) -> RigConfig:
    """A rig that may not go any faster than it did."""
    assert one_plane.limits is not None
    return one_plane.model_copy(update={"limits": one_plane.limits.model_copy(update={"overspeed": 2100 / RPM})})


def test_a_late_probe_and_a_turned_one_are_told_apart_by_turning_the_other_way(
    below_critical: RigConfig, hidden: NDArray[np.float64]
) -> None:
    """A turned probe lags one way round and leads the other, a late one lags both ways."""
    late = [(find(below_critical, "delay, probe 1y"), LATE)]
    forward = swept_response(below_critical, rng=np.random.default_rng(5), hidden=late, **BELOW)
    tied = selected(forward, hidden, LATE_OR_TURNED)
    found = find_next_run(tied)
    assert found is not None
    assert found.kind == "reverse rotation"
    assert found.lam >= VERDICT.nameable
    assert set(found.separates) == set(LATE_OR_TURNED)
    other_way = below_critical.turned_over
    made = swept_response(other_way, rng=np.random.default_rng(6), hidden=late, unbalance=np.conj(U), **BELOW)
    reverse = Recording(made, number=1, backward=True)
    mark = [MarkEdge.of_recording(1)]
    best, *rivals = selected(forward, hidden, LATE_OR_TURNED, more=[reverse], nuisances=mark).steps[0].tried
    assert best.effect.label == "delay, probe 1y"
    assert all(best.evidence > rival.evidence + VERDICT.nameable for rival in rivals)
    assert best.polished.chi2 < best.polished.dof, "the reversed rotor is the one of the config that turns from y to x"


def test_no_run_is_proposed_that_may_come_near_a_limit(tied: Selection, one_plane: RigConfig) -> None:
    """What the first pass of the resonance would do is known no better than stiffness and damping are."""
    found = find_next_run(tied)
    assert found is not None
    assert 0 < found.share_of_limit <= VERDICT.of_limit
    plan = next(plan for plan in plans(tied.problem.recordings[0].response) if plan.kind == "ramp rate")
    limits = one_plane.limits
    assert limits is not None
    fit = tied.problem, draw_left_open(tied.problem, tied.polished)
    share = share_of_limit(*fit, plan, limits)
    low = limits.model_copy(update={"vibration": limits.vibration / 10})
    assert share_of_limit(*fit, plan, low) == pytest.approx(10 * share)
    highest = max(plans(tied.problem.recordings[0].response), key=lambda plan: plan.high)
    assert share_of_limit(*fit, highest, limits) > share, "through the resonance"


def test_what_the_data_do_not_determine_is_drawn_no_further_than_they_leave_open(
    tied: Selection, one_plane: RigConfig
) -> None:
    """A covariance that leads far beyond the data made every forecast infinite, and no run was proposed."""
    plan = next(plan for plan in plans(tied.problem.recordings[0].response) if plan.kind == "ramp rate")
    assert one_plane.limits is not None
    limits, near = one_plane.limits, draw_left_open(tied.problem, tied.polished)
    share = share_of_limit(tied.problem, near, plan, limits)
    far = replace(tied.polished, covariance=1e8 * tied.polished.covariance)
    drawn = draw_left_open(tied.problem, far)
    assert len(drawn) == len(near) == VERDICT.draws + 1
    assert 0.5 * share < share_of_limit(tied.problem, drawn, plan, limits) < 2 * share


def test_a_fit_that_is_worse_than_the_noise_leaves_as_much_more_open(
    tied: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its covariance is scaled up by that: when the rise of chi2 was not, 1,000 residuals were taken to shorten it."""
    problem, fit = tied.problem, tied.polished
    fit = replace(fit, covariance=np.diag(np.diag(fit.covariance)))  # a bound that stops one unknown moves no other
    poor = replace(fit, chi2=16.0 * fit.dof, covariance=16.0 * fit.covariance)
    asked = count_asked(monkeypatch, problem, fit, chi2=poor.chi2)
    far = draw_left_open(problem, poor)
    assert len(asked) == VERDICT.draws, "each is asked once, and none is shortened"
    count_asked(monkeypatch, problem, fit, chi2=fit.chi2)
    near = draw_left_open(problem, fit)
    wider = [np.linalg.norm(far[i] - fit.p) > 2 * np.linalg.norm(near[i] - fit.p) for i in range(1, len(far))]
    assert np.mean(wider) > 0.7, "four times as far, but for bounds"


def test_one_unknown_that_is_open_is_told_from_the_others_by_halves(
    tied: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, fit = tied.problem, tied.polished
    axis = np.linalg.eigh(fit.covariance)[1][:, -1]
    far = replace(fit, covariance=fit.covariance + 1e4 * np.outer(axis, axis))
    asked = count_asked(monkeypatch, problem, fit, chi2=fit.chi2)
    draw_left_open(problem, far)
    assert len(asked) < len(fit.p) + VERDICT.draws, "one by one it was all of them, and more"


def count_asked(
    monkeypatch: pytest.MonkeyPatch, problem: ExtendedProblem, fit: Solution, *, chi2: float
) -> list[NDArray[np.float64]]:
    """Make the sum of squares that of a linear model whose least is `chi2`; return the places it is asked for."""
    asked: list[NDArray[np.float64]] = []
    root = np.linalg.cholesky(fit.covariance)

    def rise(_: ExtendedProblem, p: NDArray[np.float64]) -> float:
        asked.append(p)
        return chi2 + squared_distance(p - fit.p, root)

    monkeypatch.setattr(type(problem), "sum_squares", rise)
    return asked


def test_what_the_data_determine_keeps_its_spread_beside_what_they_do_not(
    tied: Selection, one_plane: RigConfig
) -> None:
    """Else the forecast of a rotor with one unknown that is open would be that of its fit, which is too low."""
    plan = next(plan for plan in plans(tied.problem.recordings[0].response) if plan.kind == "ramp rate")
    assert one_plane.limits is not None
    limits, fit = one_plane.limits, tied.polished
    axis = np.linalg.eigh(fit.covariance)[1][:, -1]
    far = replace(fit, covariance=fit.covariance + 1e8 * np.outer(axis, axis))
    near, drawn = (draw_left_open(tied.problem, each) for each in (fit, far))
    of_fit, share, found = (share_of_limit(tied.problem, vectors, plan, limits) for vectors in ([fit.p], near, drawn))
    assert share > 1.01 * of_fit
    assert found > of_fit + 0.5 * (share - of_fit)


def test_a_run_whose_motion_overflows_is_over_every_limit(
    tied: Selection, one_plane: RigConfig, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = next(plan for plan in plans(tied.problem.recordings[0].response) if plan.kind == "ramp rate")
    predict = ExtendedModel.predict

    def beyond(model: ExtendedModel, p: NDArray[np.float64], **how: Any) -> list[dict[int, NDArray[np.complex128]]]:
        return [
            {n: z * 1e200 * (1e200 if recording.planned else 1e-200) for n, z in each.items()}
            for recording, each in zip(model.recordings, predict(model, p, **how), strict=True)
        ]

    monkeypatch.setattr(ExtendedModel, "predict", beyond)
    assert one_plane.limits is not None
    left_open = draw_left_open(tied.problem, tied.polished)
    assert share_of_limit(tied.problem, left_open, plan, one_plane.limits) == np.inf


def test_where_no_run_may_be_made_it_says_so(tied: Selection, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice.share_of_limit", lambda *_: 0.9)
    found = find_other_run(tied)
    assert not found.planned
    assert "its vibration may reach 90 % of a limit, want 70 %" in found.words
    loud = find_next_run(tied)
    assert loud is not None
    assert (loud.planned, loud.share_of_limit) == (True, 0.9), "told, for a person to decide"


def test_what_nothing_explains_is_run_to_a_higher_speed_and_a_kind_that_is_not_possible_is_passed_over(
    tied: Selection,
) -> None:
    found = find_other_run(tied)
    assert (found.kind, found.separates) == ("through critical", ())
    assert find_other_run(tied, not_possible={"through critical"}).kind == "trial mass"
    assert find_other_run(tied, not_possible={"through critical"}).trial == ("disk: 12 g mm at 90 deg",)


def test_a_run_that_was_made_is_not_proposed_again(
    tied: Selection, one_plane: RigConfig, hidden: NDArray[np.float64]
) -> None:
    first = tied.problem.recordings[0].response
    bow = [(find(one_plane, "bow"), BOW)]
    fast = swept_response(one_plane, rng=np.random.default_rng(8), hidden=bow, speeds=(480, 1500), ramp=RAMP * 3)
    both = selected(first, hidden, more=[Recording(fast, number=1)])
    not_possible = {"through critical", "trial mass"}
    before = find_other_run(tied, not_possible=not_possible)
    assert before.ramp == pytest.approx(RAMP / RPM / 3, rel=0.05), "the slower one first"
    slow = swept_response(one_plane, rng=np.random.default_rng(9), hidden=bow, speeds=(480, 1500), ramp=RAMP / 3)
    after = selected(first, hidden, more=[Recording(slow, number=1)])
    assert find_other_run(after, not_possible=not_possible).ramp == pytest.approx(RAMP / RPM * 3, rel=0.05)
    assert find_other_run(both, not_possible=not_possible).ramp == pytest.approx(RAMP / RPM / 3, rel=0.05)


def test_a_plan_whose_forecast_fails_is_not_proposed(tied: Selection, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> float:
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr("rotorrig.identify.verdict.next_run.choice.share_of_limit", fail)
    for found in (find_next_run(tied), find_other_run(tied)):
        assert found is not None
        assert not found.planned
        assert "Singular matrix" in found.words
