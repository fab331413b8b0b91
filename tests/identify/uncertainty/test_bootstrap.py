"""The bootstrap scatters as the covariance says, is the same for any number of processes, and can be interrupted."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.identify.uncertainty.bootstrap import Bootstrap, Resampling, bootstrap, simulate_draw
from rotorrig.identify.uncertainty.intervals import standard_deviation
from rotorrig.identify.uncertainty.quantities import quantities
from rotorrig.identify.uncertainty.settings import UNCERTAINTY
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import matched_response, sought
from tests.identify.problems import problem_of, refine

TRUTH = np.array([33e3, 36e3, 14.0, 16.0])


@pytest.fixture(scope="module")
def response(rig_config: RigConfig) -> OrderTrackedResponse:
    bearing = np.diag(TRUTH[:2]), np.diag(TRUTH[2:])
    rng = np.random.default_rng(3)
    made = matched_response(
        sought(rig_config), bearings={"spring": bearing}, unbalance={"disk": -14e-6}, rng=rng, noise=3e-6
    )
    kept = np.arange(0, len(made.omega), 3)
    rows = ("run", "t", "omega", "alpha", "revolutions", "z", "covariance", "usable")
    fewer = {name: getattr(made, name)[kept] for name in rows}
    return replace(made, **fewer, reasons=((),) * len(kept))


@pytest.fixture(scope="module")
def problem(response: OrderTrackedResponse) -> ExtendedProblem:
    return problem_of(response)


@pytest.fixture(scope="module")
def best(problem: ExtendedProblem) -> Solution:
    return refine(problem, TRUTH)


@pytest.fixture(scope="module")
def found(problem: ExtendedProblem, best: Solution) -> Bootstrap:
    return bootstrap(problem, best, draws=80, seed=5)


@pytest.mark.campaign
def test_the_draws_scatter_as_the_covariance_says(problem: ExtendedProblem, best: Solution, found: Bootstrap) -> None:
    for i, quantity in enumerate(quantities(problem.parameters.base, best.p)):
        draws = np.log(found.draws[:, i]) if quantity.name[0] in "kc" else found.draws[:, i]
        stated = standard_deviation(best, quantity)
        assert draws.std() == pytest.approx(stated, rel=0.3), quantity.name  # four sigma of 80 draws
        assert abs(draws.mean() - quantity.read(best.p)) < 0.5 * stated, quantity.name


@pytest.mark.campaign
def test_phases_are_told_about_the_estimate_across_half_a_turn(found: Bootstrap, best: Solution) -> None:
    low, high = found.interval("phase") or (0.0, 0.0)
    assert high - low < 0.2  # and not a whole turn, though the unbalance is at 180 degrees
    assert min(abs(abs(low) - np.pi), abs(abs(high) - np.pi)) < 0.1


def test_simulated_vectors_scatter_by_noise_and_priors(problem: ExtendedProblem, best: Solution) -> None:
    rng = np.random.default_rng(0)
    slow_roll = np.array([simulate_draw(problem, best, rng=rng)[1][0][1][-1] for _ in range(400)])
    prior = problem.parameters.prior_sigma[problem.parameters.base.runout][0]
    expected = np.full(4, np.hypot(prior, 3e-6))
    np.testing.assert_allclose(slow_roll.real.std(axis=0), expected, rtol=0.15)  # four sigma of 400 draws
    np.testing.assert_allclose(slow_roll.imag.std(axis=0), expected, rtol=0.15)


@pytest.mark.campaign
def test_a_draw_depends_on_the_seed_and_its_number_alone(
    problem: ExtendedProblem, best: Solution, found: Bootstrap
) -> None:
    again = bootstrap(problem, best, draws=4, seed=5, workers=2)
    np.testing.assert_allclose(again.draws, found.draws[:4], rtol=1e-9)
    other = bootstrap(problem, best, draws=1, seed=6)
    assert np.abs(other.draws[0] / found.draws[0] - 1).max() > 1e-4


@pytest.mark.campaign
@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_keeps_the_draws_done(problem: ExtendedProblem, best: Solution, found: Bootstrap, workers: int) -> None:
    def impatient(done: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    kept = bootstrap(problem, best, draws=10_000, seed=5, workers=workers, progress=impatient)
    assert kept.asked == 10_000
    assert len(kept.draws) == 3
    assert all(np.isclose(row, found.draws).all(axis=1).any() for row in kept.draws)
    assert kept.interval("kxx") is None


def test_the_interval_leaves_out_a_fortieth_of_the_draws_at_either_end() -> None:
    draws = np.arange(1.0, 80.0)[:, None]  # 79 of them leave 80 gaps, two of which are a fortieth
    found = Bootstrap(names=("kxx",), draws=draws, asked=79, seed=0)
    assert found.interval("kxx") == pytest.approx((2.0, 78.0))
    assert (
        Bootstrap(names=("kxx",), draws=draws[: UNCERTAINTY.fewest_draws - 1], asked=79, seed=0).interval("kxx") is None
    )


@pytest.mark.campaign
def test_a_fit_takes_its_intervals_from_the_bootstrap(response: OrderTrackedResponse, found: Bootstrap) -> None:
    counted: list[int] = []
    asked = Resampling(draws=UNCERTAINTY.fewest_draws, progress=counted.append)
    with_bootstrap_intervals = identify([response], seed=5, resampling=asked).fits[0]
    assert counted == list(range(1, UNCERTAINTY.fewest_draws + 1))
    assert {e.interval_by for e in with_bootstrap_intervals.estimates} == {"bootstrap"}
    few = identify([response], seed=5, resampling=Resampling(draws=2, search=True)).fits[0]
    assert {e.interval_by for e in few.estimates} == {"covariance"}
    assert any("2 draws" in words for words in few.words)
