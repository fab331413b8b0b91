"""The search finds what made the data, from nowhere near it, in few calls, and ends by itself."""

import numpy as np
import pytest

from rotorrig.identify.base_model.global_search import SearchResult, search, search_amplitudes
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.identify.measurement import measure
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import draw, expected_estimates
from tests.conftest import BLIND_SEED
from tests.identify.matched import matched_response, sought
from tests.parameters import defer_rest

U = 12e-6 * np.exp(2j)
SPRING = (np.diag([31e3, 37e3]), np.diag([18.0, 12.0]))


def found_in(response: OrderTrackedResponse, **how: object) -> SearchResult:
    return search(response, measure(response), Space.of(response.rig), **how)


@pytest.fixture(scope="module")
def clean(rig_config: RigConfig) -> OrderTrackedResponse:
    rng = np.random.default_rng(1)
    return matched_response(sought(rig_config), bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng, noise=1e-8)


@pytest.mark.parametrize("objective", ["residual", "f1", "f2", "f3"])
@pytest.mark.parametrize("seed", range(3))
def test_every_objective_finds_what_made_the_data(clean: OrderTrackedResponse, objective: str, seed: int) -> None:
    found = found_in(clean, objective=objective, seed=seed)
    assert found.optima[0].theta == pytest.approx([31e3, 37e3, 18.0, 12.0, 12e-6], rel=2e-3)
    assert found.evaluations < 250
    assert found.stop in ("converged", "target reached")


@pytest.mark.parametrize("method", ["modern", "seed"])
@pytest.mark.parametrize("objective", defer_rest(["f1", "f2", "f3", "residual"]))
def test_an_objective_searched_by_its_value_alone_has_the_same_minimum(
    clean: OrderTrackedResponse, objective: str, method: str
) -> None:
    by_vector, by_values = (found_in(clean, objective=objective, method=m) for m in ("vector", method))
    assert by_values.optima[0].theta == pytest.approx(by_vector.optima[0].theta, rel=1e-3)
    assert by_values.evaluations == sum(stage.evaluations for stage in by_values.trace.stages)
    assert by_values.optima[0].cost <= by_values.optima[-1].cost <= 4 * by_values.optima[0].cost


@pytest.mark.parametrize("method", ["vector", "modern", "seed"])
def test_a_search_leaves_its_trace(clean: OrderTrackedResponse, method: str) -> None:
    trace = found_in(clean, objective="f1", method=method).trace
    assert trace.method == method
    names = [stage.name for stage in trace.stages]
    assert names[:2] == ["genetic" if method == "seed" else "gather", "local"]
    assert len(trace.heads) >= 1
    assert trace.points.shape[1] == trace.heads.shape[1] == (4 if method == "vector" else 5)
    assert (trace.points[:, :2] >= 1e2).all()
    assert (trace.points[:, :2] <= 1e6).all()


@pytest.mark.campaign
def test_the_blind_plants_values_are_found_near_enough_to_be_refined(blind_response: OrderTrackedResponse) -> None:
    truth = expected_estimates(blind_response.rig, draw(blind_response.rig, seed=BLIND_SEED))
    found = found_in(blind_response)
    values = dict(zip((*Space.of(blind_response.rig).names, "u"), found.optima[0].theta, strict=True))
    for name in ("kxx", "kyy", "u"):
        assert values[name] == pytest.approx(truth[name], rel=0.1), name


def test_all_eight_coefficients_are_found(rig_config: RigConfig, rng: np.random.Generator) -> None:
    K, C = np.array([[30e3, 6e3], [-4e3, 38e3]]), np.array([[18.0, 3.0], [-2.0, 12.0]])
    rig = sought(rig_config, coefficients="all")
    response = matched_response(rig, bearings={"spring": (K, C)}, unbalance={"disk": U}, rng=rng)
    theta = found_in(response).optima[0].theta
    assert theta[:4] == pytest.approx(K.ravel(), rel=0.02)
    assert theta[4:8] == pytest.approx(C.ravel(), abs=1.0)


def test_bearings_are_found_apart_and_modulus_stays_the_nameplates(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    left = (np.diag([8e5, 9e5]), np.diag([30.0, 40.0]))
    rig = sought(rig_config, bearings=[["left A", "left B"], ["spring"]], k_bounds=[1e2, 1e8], also=["youngs_modulus"])
    response = matched_response(
        rig, bearings={"left A": left, "left B": left, "spring": SPRING}, unbalance={"disk": U}, rng=rng
    )
    theta = found_in(response).optima[0].theta
    assert theta[0:2] == pytest.approx([8e5, 9e5], rel=0.05)
    assert theta[4:8] == pytest.approx([31e3, 37e3, 18.0, 12.0], rel=0.05)
    assert theta[8] == pytest.approx(rig.shaft.youngs_modulus)


@pytest.mark.parametrize("objective", ["f1", "f2", "f3"])
def test_in_noise_each_objective_is_lower_than_at_the_truth_and_all_around(
    rig_config: RigConfig, rng: np.random.Generator, objective: str
) -> None:
    response = matched_response(
        sought(rig_config), bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng, noise=1e-6
    )
    amplitudes = Amplitudes.of(response, measure(response), Space.of(response.rig))
    optima, *_ = search_amplitudes(amplitudes, objective=objective, rng=rng)
    best = np.array(optima[0].theta)
    around = best * np.exp(rng.normal(0, 1, (200, 5)) * 10 ** rng.uniform(-6, -1, (200, 1)))
    others = np.vstack([around, [31e3, 37e3, 18.0, 12.0, 12e-6]])
    cost = amplitudes.cost(best[None], objective=objective)[0]
    assert optima[0].cost == pytest.approx(cost)
    assert cost <= amplitudes.cost(others, objective=objective).min()


def test_what_one_probe_alone_does_not_tell_is_no_trouble(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(rig_config.model_copy(update={"probes": rig_config.probes[:1]}))
    response = matched_response(rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    assert found_in(response).optima[0].theta[0] == pytest.approx(31e3, rel=0.05)


def test_the_same_seed_gives_the_same_search(clean: OrderTrackedResponse) -> None:
    first, second = (found_in(clean, seed=4) for _ in range(2))
    assert (first.optima, first.evaluations) == (second.optima, second.evaluations)


def test_another_name_is_refused(clean: OrderTrackedResponse) -> None:
    with pytest.raises(ValueError, match="objective is 'f4', want 'residual'"):
        found_in(clean, objective="f4")
