"""What a Jacobian can tell, on a fit whose Jacobian is replaced by one with known singular directions."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.identify.uncertainty.identifiability import Identifiability
from rotorrig.identify.uncertainty.identifiability_text import describe_identifiability
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, load
from tests.conftest import CONFIGS
from tests.identify.matched import matched_response, sought
from tests.identify.problems import problem_of, refine
from tests.identify.test_bearing_sets import SPRING, U


@pytest.fixture(scope="module")
def response() -> OrderTrackedResponse:
    rig = sought(load(CONFIGS / "rk4.toml"))
    rng = np.random.default_rng(0)
    return matched_response(rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng, noise=1.5e-7)


@pytest.fixture(scope="module")
def problem(response: OrderTrackedResponse) -> ExtendedProblem:
    return problem_of(response)


@pytest.fixture(scope="module")
def best(problem: ExtendedProblem) -> Solution:
    return refine(problem, np.array([31e3, 37e3, 18.0, 12.0]))


def pretended(best: Solution, problem: ExtendedProblem, columns: np.ndarray) -> Solution:
    """The same fit as if the data depended as the columns say on kxx, kyy, cxx, cyy, log u and phase alone."""
    figures = len(best.jacobian) - len(problem.parameters.priors)
    jacobian = best.jacobian.copy()
    jacobian[:figures] = 0
    jacobian[: len(columns), :4] = columns[:, :4]
    u = complex(*best.p[problem.parameters.base.unbalance])
    to_re_im = np.linalg.inv([[u.real, -u.imag], [u.imag, u.real]])
    jacobian[: len(columns), problem.parameters.base.unbalance] = columns[:, 4:] @ to_re_im
    return replace(best, jacobian=jacobian, chi2=float(best.dof))


def said(best: Solution, problem: ExtendedProblem, *, unseen: str = "") -> tuple[str, ...]:
    return describe_identifiability(best, problem, Identifiability(best, problem.parameters), unseen=unseen)


def test_of_a_well_determined_fit_only_the_mass_of_the_disk_is_said_to_limit_the_unbalance(
    best: Solution, problem: ExtendedProblem
) -> None:
    (limits,) = said(best, problem)
    assert limits.startswith("The tolerances in [prior] limit u (disk mass), not the noise")


def test_directions_are_orthogonal_and_agree_with_the_covariance(best: Solution, problem: ExtendedProblem) -> None:
    able = Identifiability(best, problem.parameters)
    vectors = np.array([list(d.weights.values()) for d in able.directions()])
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(6), atol=1e-9)
    sigma = np.array([d.sigma for d in able.directions()])
    np.testing.assert_allclose(np.diag((vectors.T * sigma**2) @ vectors)[:4], np.diag(best.covariance)[:4], rtol=1e-6)
    assert (np.diff(sigma) <= 0).all()
    assert all(d.sigma_of_noise <= d.sigma * (1 + 1e-9) for d in able.directions())


def test_two_columns_that_are_alike_cannot_be_separated_but_their_combination_is_known(
    best: Solution, problem: ExtendedProblem
) -> None:
    columns = 1e3 * np.eye(6)
    columns[4] = 0
    columns[2, 4] = 1e3  # the data see cxx times u alone
    assert said(pretended(best, problem, columns), problem) == (
        "cxx and u cannot be separated by this data: cxx 10 % higher and u 10 % lower at once would hardly show; "
        "cxx × u is known to 0.1 %.",
    )


def test_what_no_column_shows_is_not_determined_and_is_not_called_tied(
    best: Solution, problem: ExtendedProblem
) -> None:
    columns = 1e3 * np.eye(6)
    columns[1, 1] = columns[3, 3] = 0.1  # kyy and cyy: their singular vectors may be mixed at will
    sentences = said(pretended(best, problem, columns), problem)
    assert sentences == (
        "kyy is not determined by this data (a factor of 2.2e+04 either way).",
        "cyy is not determined by this data (a factor of 2.2e+04 either way).",
    )


def test_an_undetermined_phase_is_said_in_degrees(best: Solution, problem: ExtendedProblem) -> None:
    columns = 1e3 * np.eye(6)
    columns[5, 5] = 1.0
    assert said(pretended(best, problem, columns), problem) == ("phase is not determined by this data (± 57 degrees).",)


def test_what_is_led_astray_by_something_open_is_named_too(best: Solution, problem: ExtendedProblem) -> None:
    columns = 1e3 * np.eye(6)
    columns[0, 0], columns[0, 3] = 1.0, 1.0  # kxx shows as 1 with cyy, which alone shows as 1.4
    columns[3, 3] = 1.0
    sentences = said(pretended(best, problem, columns), problem)
    assert "kxx is not determined by this data" in sentences[0]
    assert sentences[-1].startswith("cyy is not determined by this data")


def test_pairs_far_better_known_together_are_named(best: Solution, problem: ExtendedProblem) -> None:
    columns = 1e3 * np.eye(6)
    columns[0, 0], columns[0, 1] = 1e5, -1e5
    assert said(pretended(best, problem, columns), problem) == (
        "kxx and kyy are 1.000 correlated: kxx / kyy is known to 0.001 %, better than either.",
    )


def test_an_axis_no_probe_looks_along_is_said_once(best: Solution, problem: ExtendedProblem) -> None:
    assert said(best, problem, unseen="y")[:-1] == ("No probe looks along y: kyy and cyy are not determined.",)


def test_the_budget_tells_noise_from_the_nameplates_tolerances(
    best: Solution, problem: ExtendedProblem, response: OrderTrackedResponse
) -> None:
    budget = Identifiability(best, problem.parameters).budget()
    for shares in budget.values():
        assert sum(shares.values()) == pytest.approx(1)
    of_probes = {"probe gain", "probe angle", "probe linearity", "runout", "keyphasor angle"}  # no hum: it has no times
    of_rotor = {"E", "disk mass", "other bearings", "positions", "diameter", "hubs", "tilt stiffness"}
    assert set(budget["u"]) == {"noise", "internal damping"} | of_rotor | of_probes
    assert budget["u"]["probe gain"] > budget["kxx"]["probe gain"]
    rig = response.rig
    loose = rig.model_copy(update={"prior": rig.prior.model_copy(update={"probe_gain": 0.2})})
    scaled = replace(response, rig=loose)
    problem = problem_of(scaled)
    able = refine(problem, np.array([31e3, 37e3, 18.0, 12.0]))
    assert Identifiability(able, problem.parameters).budget()["u"]["probe gain"] > 0.9
    assert "The tolerances in [prior] limit u (probe gain), not the noise" in said(able, problem)[-1]


def test_a_value_at_its_bound_is_not_given_by_the_data(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(rig_config, c_bounds=[1.0, 15.0])
    made = matched_response(rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    problem = problem_of(made)
    best = refine(problem, problem.parameters.base.space.nameplate)
    assert "cxx ran into its bound of 15 N s/m: this data does not give it." in said(best, problem)
