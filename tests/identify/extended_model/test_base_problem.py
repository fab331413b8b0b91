"""The least-squares problem: its derivatives, trial masses, and parameters held fixed."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.least_squares.solve import inverse_information
from rotorrig.identify.measurement import measure
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import matched_response, sought
from tests.identify.problems import problem_of, refine
from tests.identify.test_bearing_sets import SPRING, U

K_AND_C = np.array([33900.0, 34600.0, 15.0, 15.0])


@pytest.fixture(scope="module")
def problem(blind_response: OrderTrackedResponse) -> ExtendedProblem:
    return problem_of(blind_response)


def differences(problem: ExtendedProblem, p: np.ndarray, i: int, *, step: float = 1e-5) -> np.ndarray:
    """Central differences, with steps that move the residual by far more than it is rounded by."""
    name = problem.parameters.names[i]
    if name.startswith(("u ", "runout")):
        step = 1e-10
    elif name.startswith("tilt"):
        step = 1e-3  # hardly felt
    ahead, behind = p.copy(), p.copy()
    ahead[i] += step
    behind[i] -= step
    return (problem.residual(ahead) - problem.residual(behind)) / (2 * step)


def inside(problem: ExtendedProblem, p: np.ndarray) -> np.ndarray:
    """The same with what is never below zero above it: a central difference takes both sides."""
    names = problem.parameters.base
    p[names.hubs], p[names.tilts] = 0.2, 30.0
    return p


def test_the_jacobian_is_the_derivative_of_the_residual(problem: ExtendedProblem) -> None:
    p = inside(problem, problem.begin(K_AND_C))
    p[problem.parameters.base.gain] += 0.01
    p[problem.parameters.base.angle] -= 0.02
    jacobian = problem.jacobian(p)
    for i, name in enumerate(problem.parameters.names):
        central = differences(problem, p, i)
        assert np.linalg.norm(jacobian[:, i] - central) < 1e-3 * np.linalg.norm(central), name
    some = np.array([1, 5, len(p) - 1])
    np.testing.assert_allclose(problem.jacobian(p, some), jacobian[:, some], rtol=1e-9, atol=1e-6)


def test_the_jacobian_of_a_compensated_table_is_the_derivative(blind_response: OrderTrackedResponse) -> None:
    nothing = np.full_like(blind_response.slow_roll, np.nan)
    response = replace(blind_response, slow_roll=nothing, slow_roll_omega=np.nan, compensation_omega=100.0)
    problem = problem_of(response)
    p = inside(problem, problem.begin(K_AND_C))
    assert not problem.model.predict(p)[0][1][-1].any()
    jacobian = problem.jacobian(p)
    for i, name in enumerate(problem.parameters.names):
        central = differences(problem, p, i)
        if name.startswith("runout"):
            figures = 2 * problem.recordings[0].measured[1].z.size
            assert not jacobian[:figures, i].any(), "it is in every vector alike"
        else:
            assert np.linalg.norm(jacobian[:, i] - central) < 1e-3 * np.linalg.norm(central), name


def test_the_jacobian_of_every_kind_of_unknown_is_the_derivative(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    rig = sought(
        rig_config,
        bearings=[["left A", "left B"], ["spring"]],
        coefficients="all",
        also=["density", "youngs_modulus"],
        k_bounds=[1e2, 1e8],
    )
    response = matched_response(rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    problem = problem_of(response)
    p = problem.begin(
        problem.parameters.base.space.nameplate * rng.uniform(0.9, 1.1, len(problem.parameters.base.space))
    )
    inside(problem, p)[problem.parameters.base.sought][1] = 3e-4  # kxy of the left bearings, in parts of 1e8 N/m
    jacobian = problem.jacobian(p)
    for i, name in enumerate(problem.parameters.names):
        step = 1e-3 if name.endswith(("cxx", "cyy")) else 1e-5 if name.startswith("internal_damping") else 1e-6
        central = differences(problem, p, i, step=step)
        assert np.linalg.norm(jacobian[:, i] - central) < 2e-4 * np.linalg.norm(central), name


def test_a_known_trial_mass_is_not_taken_for_the_unbalance_sought(blind_response: OrderTrackedResponse) -> None:
    up, down = (i for i, run in enumerate(blind_response.runs) if run.direction)
    weighted = list(blind_response.runs)
    weighted[down] = replace(weighted[down], trial_unbalance={"disk": 12e-6j})
    response = replace(blind_response, runs=tuple(weighted))
    problem = problem_of(response)
    p = problem.begin(K_AND_C)
    p[problem.parameters.base.unbalance] = 3e-6, -4e-6
    made, slow, first = response.z.copy(), response.slow_roll.copy(), response.orders.index(1.0)
    rows = measure(response).rows
    made[rows, :, first], slow[:, first] = np.split(problem.model.predict(p)[0][1], [-1])
    bare = problem.model.predict(p)[0][1][:-1] - problem_of(blind_response).model.predict(p)[0][1][:-1]
    assert np.abs(bare[response.run[rows] == up]).max() == 0
    assert np.abs(bare[response.run[rows] == down]).max() > 100e-6
    rebuilt = replace(response, z=made, slow_roll=slow)
    again = problem_of(rebuilt).begin(K_AND_C)
    assert again[problem.parameters.base.unbalance] == pytest.approx([3e-6, -4e-6], rel=0.01)


def test_a_parameter_held_fixed_stays_and_the_others_make_the_best_of_it(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    response = matched_response(sought(rig_config), bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    problem = problem_of(response)
    best = refine(problem, K_AND_C)
    for i in (0, problem.parameters.names.index("gain 1x"), problem.parameters.names.index("runout 2y im")):
        away = best.p[i] + 2 * best.sigma[i]
        held = problem.solve(best.p, fixed={i: away})
        assert held.p[i] == away
        assert held.sigma[i] == 0
        assert held.dof == best.dof + 1
        assert held.chi2 - best.chi2 == pytest.approx(4.0, rel=0.05)  # two sigmas, near enough linear


def test_from_the_nameplate_and_from_the_truth_the_same_minimum_is_reached(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    response = matched_response(sought(rig_config), bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    problem = problem_of(response)
    far, near = refine(problem, K_AND_C), refine(problem, np.array([31e3, 37e3, 18.0, 12.0]))
    assert far.chi2 == pytest.approx(near.chi2, abs=1e-5)
    assert (np.abs(far.p - near.p) < 2e-3 * near.sigma).all()


def test_what_no_row_depends_on_gets_a_large_variance_and_not_a_small_one() -> None:
    jacobian = np.array([[2.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 1.0, 0.0]])
    variance = np.diag(inverse_information(jacobian))
    assert variance[0] == pytest.approx(0.25)
    assert (variance[1:] > 1e12).all()
