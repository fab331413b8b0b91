"""Where force laws are begun, on recordings of the model under a law of known size."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.causes.force_law_starts import score_force_laws
from rotorrig.identify.causes.pinned_nuisances import fit_with_pinned_nuisances, nuisances_biased
from rotorrig.identify.causes.score_test import Score
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response


@pytest.fixture(scope="module")
def passed(rig: RigConfig) -> OrderTrackedResponse:
    return swept_response(rig, orders=(1,), speeds=(900, 2600), ramp=600)


def under(response: OrderTrackedResponse, hidden: NDArray[np.float64], label: str, **theta: float) -> ExtendedProblem:
    """Return the base problem of what the probes would show under a force law."""
    effect = find(response.rig, label)
    lawful = ExtendedProblem(ExtendedModel([Recording(response)], [effect]))
    p = lawful.parameters.start(hidden)
    values = effect.at_zero | theta
    p[lawful.parameters.own] = [values[q.name] / q.size for q in effect.parameters]
    (predicted,) = lawful.model.predict(p)
    return ExtendedProblem(ExtendedModel([lawful.recordings[0].instead(predicted)]))


def raced(problem: ExtendedProblem, hidden: NDArray[np.float64], *labels: str) -> tuple[Solution, list[Score]]:
    """Return the base as a strong law draws it off, and the scores of the laws."""
    rig = problem.recordings[0].response.rig
    base = problem.solve(problem.parameters.start(hidden), tolerance=0.1, max_steps=15)
    return base, score_force_laws(
        problem, base, fit_with_pinned_nuisances(problem, base.p), [find(rig, label) for label in labels]
    )


@pytest.mark.parametrize(
    ("label", "theta"),
    [
        ("cubic_spring", {"k3": 3e10}),
        ("cubic_spring", {"k3": -4e9}),
        ("clearance", {"gap": 12e-6}),
        ("rub, at disk", {"gap": 200e-6, "stiffness": 2e4, "friction": 0.05}),
    ],
)
def test_a_hidden_law_is_found_with_its_size_and_before_another(
    passed: OrderTrackedResponse, hidden: NDArray[np.float64], label: str, theta: dict[str, float]
) -> None:
    problem = under(passed, hidden, label, **theta)
    base, (first, *_) = raced(problem, hidden, label, "friction")
    assert first.effect.label == label
    assert first.begin is not None
    own = problem.extended([first.effect]).parameters
    found = own.of_effect(first.begin, 0)
    for name, value in theta.items():
        assert found[name] == pytest.approx(value, rel=0.05), name
    assert first.lam == pytest.approx(base.chi2, rel=0.01), "all that was wrong is explained"


def test_where_a_law_begins_the_nuisances_are_at_their_priors(
    passed: OrderTrackedResponse, hidden: NDArray[np.float64]
) -> None:
    problem = under(passed, hidden, "cubic_spring", k3=3e10)
    _, found = raced(problem, hidden, "cubic_spring", "friction")
    held = problem.parameters.pinned
    for score in found:
        assert score.begin is not None
        assert not nuisances_biased(problem.extended([score.effect]), score.begin)
        assert all(score.begin[i] == value for i, value in held.items())


def test_a_law_far_behind_the_best_is_not_fitted_to_the_end(
    passed: OrderTrackedResponse, hidden: NDArray[np.float64]
) -> None:
    """Dry friction cannot do what a cubic spring does: its score is far from that, and it is the least of them."""
    problem = under(passed, hidden, "cubic_spring", k3=3e10)
    _, found = raced(problem, hidden, "cubic_spring", "friction")
    assert [score.effect.name for score in found] == ["cubic_spring", "friction"]
    assert found[1].lam < 0.5 * found[0].lam


def test_what_is_solved_for_in_every_step_is_not_held(
    passed: OrderTrackedResponse, hidden: NDArray[np.float64]
) -> None:
    names = ExtendedProblem(ExtendedModel([Recording(passed)])).parameters
    held = {names.names[i] for i in ExtendedModel([Recording(passed)]).parameters.pinned}
    assert any(name.startswith("gain") for name in held)
    assert not any(name.startswith(("runout", "hum", "kxx", "unbalance")) for name in held)


def test_only_effects_that_have_starts_are_raced(passed: OrderTrackedResponse, hidden: NDArray[np.float64]) -> None:
    problem = under(passed, hidden, "cubic_spring", k3=3e9)
    _, found = raced(problem, hidden, "bow", "cubic_spring")
    assert [score.effect.name for score in found] == ["cubic_spring"]
