"""Residuals: nil at what made the data, their derivatives true, their sums the chapter's objectives."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.base_model.objectives import Amplitudes, ComplexResidual, ObjectiveName, Vector
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.identify.measurement import measure
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.errors import ConfigError, DataError
from tests.identify.matched import matched_response, sought

K, C = np.diag([31e3, 37e3]), np.diag([18.0, 12.0])
U = 12e-6 * np.exp(2j)


def made(rig: RigConfig, rng: np.random.Generator, *, noise: float = 1e-9, **more: object) -> OrderTrackedResponse:
    given = {"bearings": {"spring": (K, C)}, "unbalance": {"disk": U}} | more
    return matched_response(rig, rng=rng, noise=noise, **given)


@pytest.fixture(scope="module")
def response(rig_config: RigConfig) -> OrderTrackedResponse:
    return made(sought(rig_config), np.random.default_rng(1))


@pytest.fixture(scope="module")
def amplitudes(response: OrderTrackedResponse) -> Amplitudes:
    return Amplitudes.of(response, measure(response), Space.of(response.rig))


@pytest.fixture(scope="module")
def vectors(response: OrderTrackedResponse) -> ComplexResidual:
    return ComplexResidual.of(response, measure(response), Space.of(response.rig))


def place(space: Space, values: list[float]) -> NDArray[np.float64]:
    low, high = space.working_bounds.T
    return (space.to_working(values) - low) / (high - low)


def central(fun: Vector, u: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([(fun(u + h)[0] - fun(u - h)[0]) / 2e-6 for h in 1e-6 * np.eye(len(u))], axis=1)


@pytest.mark.parametrize("name", ["shape", "log_ratios", "differences"])
def test_derivatives_of_the_amplitudes_residuals(amplitudes: Amplitudes, name: str) -> None:
    fun = getattr(amplitudes, name)
    u = np.array([0.6, 0.65, 0.4, 0.5, 0.55])[: 4 if name == "shape" else 5]
    assert fun(u)[1] == pytest.approx(central(fun, u), rel=1e-5, abs=1e-6 * np.abs(fun(u)[1]).max())


def test_their_sums_are_f1_f2_and_f3(amplitudes: Amplitudes) -> None:
    v = np.array([0.6, 0.65, 0.4, 0.5, 0.55])
    theta = np.array(amplitudes.theta(v))
    log, micrometres = amplitudes.log_ratios(v)[0], amplitudes.differences(v)[0]
    for objective, total in (
        ("f1", (micrometres**2).sum()),
        ("f2", np.abs(log).sum()),
        ("f3", np.abs(micrometres).sum()),
    ):
        assert amplitudes.cost(theta[None], objective=objective)[0] == pytest.approx(total)


@pytest.mark.parametrize("objective", ["f1", "f2", "f3"])
def test_the_value_alone_is_that_of_the_residuals_with_derivatives(
    amplitudes: Amplitudes, objective: ObjectiveName
) -> None:
    points = np.random.default_rng(3).random((20, 4))
    costs, amounts = amplitudes.least_cost(points, objective=objective)
    for u, cost, amount in zip(points, costs, amounts, strict=True):
        off, _ = amplitudes.vector(objective)(np.append(u, amount))
        assert cost == pytest.approx(off @ off if objective == "f1" else np.abs(off).sum(), rel=1e-11)
        alone, _ = amplitudes.least_cost(u[None], objective=objective)
        assert alone[0] == pytest.approx(cost, rel=1e-11)


@pytest.mark.parametrize("objective", ["f1", "f2", "f3"])
def test_no_other_amount_within_bounds_costs_less(amplitudes: Amplitudes, objective: ObjectiveName) -> None:
    points = np.random.default_rng(4).random((10, 4))
    costs, amounts = amplitudes.least_cost(points, objective=objective)
    for u, cost, amount in zip(points, costs, amounts, strict=True):
        assert 0 <= amount <= 1
        for other in np.clip([amount - 0.01, amount - 1e-4, amount + 1e-4, amount + 0.01], 0, 1):
            theta = np.array(amplitudes.theta(np.append(u, other)))
            assert amplitudes.cost(theta[None], objective=objective)[0] >= cost * (1 - 1e-9)


def test_the_shape_is_that_of_the_best_amount(amplitudes: Amplitudes) -> None:
    u = np.array([0.6, 0.65, 0.4, 0.5])
    best = amplitudes.shape(u)[0]
    at = amplitudes.amount(u)
    assert amplitudes.log_ratios(np.append(u, at))[0] == pytest.approx(best)
    for other in (at - 0.01, at + 0.01):
        worse = amplitudes.log_ratios(np.append(u, other))[0]
        assert worse @ worse > best @ best


def test_an_amount_beyond_its_bounds_is_held_there(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(rig_config, u_bounds=[1e-7, 2e-6])
    response = made(rig, rng)
    amplitudes = Amplitudes.of(response, measure(response), Space.of(rig))
    u = place(amplitudes.steady.space, [31e3, 37e3, 18.0, 12.0])
    assert amplitudes.amount(u) == 1.0
    assert amplitudes.shape(u)[0].mean() == pytest.approx(np.log10(2 / 12), abs=1e-3)
    assert amplitudes.shape(u)[1] == pytest.approx(central(amplitudes.shape, u), rel=1e-5, abs=1e-4)


def test_at_what_made_the_data_they_vanish_with_the_slow_roll_subtracted_from_both(amplitudes: Amplitudes) -> None:
    u = place(amplitudes.steady.space, [31e3, 37e3, 18.0, 12.0])
    assert np.abs(amplitudes.shape(u)[0]).max() < 3e-3  # 1 nm of noise on 0.2 um
    assert amplitudes.theta(np.append(u, amplitudes.amount(u)))[-1] == pytest.approx(12e-6, rel=1e-4)


def test_amplitudes_within_the_noise_are_left_out(rig_config: RigConfig, rng: np.random.Generator) -> None:
    quiet, loud = (made(sought(rig_config), rng, noise=noise) for noise in (1e-9, 3e-6))
    used = [Amplitudes.of(r, measure(r), Space.of(r.rig)).figures for r in (quiet, loud)]
    assert 50 < used[1] < used[0] == 480


def test_fewer_amplitudes_than_unknowns_are_refused(amplitudes: Amplitudes) -> None:
    few = np.full((120, 4), np.nan)
    few[0] = 1e-6
    with pytest.raises(DataError, match="4 amplitudes stand out of the noise, want at least 5"):
        Amplitudes(amplitudes.steady, few, slow_roll=True)


def test_amplitudes_of_two_planes_are_refused(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(_with_plane(rig_config), unbalance=["disk", "end"])
    response = made(rig, rng)
    with pytest.raises(ConfigError, match="want one disk or plane"):
        Amplitudes.of(response, measure(response), Space.of(rig))


def test_amplitudes_of_runs_with_trial_masses_alone_are_refused(response: OrderTrackedResponse) -> None:
    runs = (Run(name="up", direction=1, trial_unbalance={"disk": 1e-5 + 0j}),)
    with pytest.raises(DataError, match="every run carries a trial mass"):
        Amplitudes.of(replace(response, runs=runs), measure(response), Space.of(response.rig))


def test_vectors_leave_the_noise_alone_at_what_made_them(vectors: ComplexResidual) -> None:
    u = place(vectors.steady.space, [31e3, 37e3, 18.0, 12.0])
    r, _ = vectors(u)
    assert vectors.amounts(u)[0] == pytest.approx(U, rel=1e-3)
    assert r @ r < 1e-6 * vectors.size


def test_a_runout_changes_nothing(response: OrderTrackedResponse, vectors: ComplexResidual) -> None:
    runout = np.array([3e-6, 2e-6j, -4e-6, 1e-6 + 1e-6j])
    measured = measure(response)
    moved = ComplexResidual.of(response, replace(measured, z=measured.z + runout), Space.of(response.rig))
    u = np.array([0.6, 0.65, 0.4, 0.5])
    assert moved(u)[0] == pytest.approx(vectors(u)[0], rel=1e-6, abs=1e-6 * np.abs(vectors(u)[0]).max())


def test_the_slope_of_the_sum_of_squares_is_true_with_the_amounts_solved_for(vectors: ComplexResidual) -> None:
    u = np.array([0.6, 0.65, 0.4, 0.5])
    r, J = vectors(u)
    assert J.T @ r == pytest.approx(central(vectors, u).T @ r, rel=1e-6)


def test_several_planes_are_told_apart(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(_with_plane(rig_config), unbalance=["disk", "end"])
    response = made(rig, rng, unbalance={"disk": U, "end": 5e-6j})
    problem = ComplexResidual.of(response, measure(response), Space.of(rig))
    u = place(problem.steady.space, [31e3, 37e3, 18.0, 12.0])
    assert problem.amounts(u) == pytest.approx([U, 5e-6j], rel=1e-2)
    r, J = problem(u + 0.05)
    assert J.T @ r == pytest.approx(central(problem, u + 0.05).T @ r, rel=1e-6)


def test_two_planes_in_one_place_are_no_error(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(_with_plane(rig_config, at=0.2805), unbalance=["disk", "end"])
    response = made(rig, rng)
    problem = ComplexResidual.of(response, measure(response), Space.of(rig))
    r, J = problem(np.array([0.6, 0.65, 0.4, 0.5]))
    assert np.isfinite(r).all()
    assert np.isfinite(J).all()


def test_a_trial_mass_is_known_on_its_runs(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(_with_plane(rig_config))
    bare = made(rig, rng)
    loaded = made(rig, rng, unbalance={"disk": U, "end": 8e-6})
    rows = np.arange(len(bare.omega)) % 2 == 1
    both = replace(
        bare,
        runs=(bare.runs[0], Run(name="with a mass", direction=1, trial_unbalance={"end": 8e-6 + 0j})),
        run=rows.astype(np.intp),
        z=np.where(rows[:, None, None], loaded.z, bare.z),
    )
    problem = ComplexResidual.of(both, measure(both), Space.of(rig))
    u = place(problem.steady.space, [31e3, 37e3, 18.0, 12.0])
    assert problem.amounts(u) == pytest.approx([U], rel=1e-3)
    assert problem(u)[0] @ problem(u)[0] < 1e-6 * problem.size
    r, J = problem(u + 0.05)
    assert J.T @ r == pytest.approx(central(problem, u + 0.05).T @ r, rel=1e-6)


def test_vectors_that_are_not_usable_play_no_part(response: OrderTrackedResponse) -> None:
    usable = response.usable.copy()
    usable[10:40, 1] = False
    spoilt = response.z.copy()
    spoilt[10:40, 1] = np.nan
    problem = ComplexResidual.of(
        replace(response, z=spoilt, usable=usable),
        measure(replace(response, z=spoilt, usable=usable)),
        Space.of(response.rig),
    )
    u = place(problem.steady.space, [31e3, 37e3, 18.0, 12.0])
    assert problem.amounts(u)[0] == pytest.approx(U, rel=1e-3)


def _with_plane(rig: RigConfig, *, at: float = 0.45) -> RigConfig:
    return from_si(rig.model_dump(mode="json") | {"planes": [{"name": "end", "position": at}]})
