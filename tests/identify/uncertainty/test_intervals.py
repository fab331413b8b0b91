"""Which intervals the estimates of a fit get, on responses of the rotor model itself."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.identification import Estimate, Fit
from rotorrig.identify.uncertainty.quantities import quantities
from rotorrig.identify.uncertainty.settings import UNCERTAINTY
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.identify.matched import matched_response, sought, taken_for_exact
from tests.identify.problems import problem_of, refine

K = np.diag([33e3, 36e3])
C = np.diag([14.0, 16.0])


def measured(rig: RigConfig, rng: np.random.Generator, *, noise: float) -> OrderTrackedResponse:
    return matched_response(rig, bearings={"spring": (K, C)}, unbalance={"disk": 14e-6j}, rng=rng, noise=noise)


@pytest.fixture
def ordinary(rig_config: RigConfig, rng: np.random.Generator) -> OrderTrackedResponse:
    """Of a rig without hubs and tilt stiffness, which bend chi2: they are never below zero."""
    plain = rig_config.prior.model_copy(update={"hub": 1e-4, "tilt": 1e-4})
    return measured(taken_for_exact(sought(rig_config.model_copy(update={"prior": plain}))), rng, noise=1e-6)


@pytest.fixture
def bounded(rig_config: RigConfig, rng: np.random.Generator) -> OrderTrackedResponse:
    """Of a rig whose cxx is its lowest allowed value, and whose noise hides it."""
    return measured(taken_for_exact(sought(rig_config, c_bounds=[14.0, 1e3])), rng, noise=1e-5)


def interval(found: Fit, name: str) -> tuple[float, float]:
    within = found.estimate(name).interval
    assert within is not None
    return within


def test_what_is_well_determined_has_the_interval_of_its_covariance(ordinary: OrderTrackedResponse) -> None:
    found = identify([ordinary]).fits[0]
    assert {e.interval_by for e in found.estimates} == {"covariance"}
    kxx, phase = found.estimate("kxx"), found.estimate("phase")
    low, high = interval(found, "kxx")
    assert np.sqrt(low * high) == pytest.approx(kxx.value)  # stiffness is a ratio: a factor either way
    assert np.log(high / low) / 2 == pytest.approx(UNCERTAINTY.half_width * kxx.sigma / kxx.value)
    assert interval(found, "phase") == pytest.approx(
        (phase.value - UNCERTAINTY.half_width * phase.sigma, phase.value + UNCERTAINTY.half_width * phase.sigma),
        abs=2e-4,
    )


@pytest.mark.campaign
def test_near_a_bound_the_profile_says_how_much_there_can_be_at_most(bounded: OrderTrackedResponse) -> None:
    found = identify([bounded]).fits[0]
    cxx = found.estimate("cxx")
    low, high = interval(found, "cxx")
    assert cxx.interval_by == "profile likelihood"
    assert low == pytest.approx(14.0)
    assert 14.1 < high < 17
    assert found.estimate("kxx").interval_by == "profile likelihood"  # correlated with it


@pytest.mark.campaign
def test_at_the_ends_of_a_profile_interval_a_refit_is_worse_by_the_rise(bounded: OrderTrackedResponse) -> None:
    problem = problem_of(bounded)
    found = identify([bounded], profile=True).fits[0]
    best = refine(problem, np.array([33e3, 36e3, 14.5, 16.0]))
    rise = UNCERTAINTY.rise * max(1.0, best.chi2 / best.dof)
    for i, name in enumerate(("kxx", "kyy")):
        for end in interval(found, name):
            held = problem.solve(best.p, fixed={i: np.log(end)})
            assert held.chi2 - best.chi2 == pytest.approx(rise, rel=0.03)


@pytest.mark.campaign
def test_on_demand_all_are_of_the_profile_and_hardly_differ_where_chi2_is_quadratic(
    ordinary: OrderTrackedResponse,
) -> None:
    asked, usual = identify([ordinary], profile=True).fits[0], identify([ordinary]).fits[0]
    assert {e.interval_by for e in asked.estimates} == {"profile likelihood"}
    for e in usual.estimates:
        width = np.ptp(interval(usual, e.name))
        assert interval(asked, e.name) == pytest.approx(interval(usual, e.name), abs=0.03 * width)


@pytest.mark.campaign
def test_coefficients_along_an_axis_no_probe_looks_at_get_no_interval(ordinary: OrderTrackedResponse) -> None:
    usable = ordinary.usable.copy()
    usable[:, [1, 3]] = False
    found = identify([replace(ordinary, usable=usable)]).fits[0]
    assert found.estimate("kyy").interval is None
    assert found.estimate("kxx").interval is not None


def test_the_quantities_are_those_of_the_estimates_in_their_order(ordinary: OrderTrackedResponse) -> None:
    problem = problem_of(ordinary)
    p = problem.begin(np.array([33e3, 36e3, 14.0, 16.0]))
    found: tuple[Estimate, ...] = identify([ordinary]).fits[0].estimates
    assert [q.name for q in quantities(problem.parameters.base, p)] == [e.name for e in found]


def test_gradients_are_derivatives(ordinary: OrderTrackedResponse) -> None:
    problem = problem_of(ordinary)
    p = problem.begin(np.array([33e3, 36e3, 14.0, 16.0]))
    for quantity in quantities(problem.parameters.base, p):
        gradient = quantity.gradient(p)
        moved = np.flatnonzero(gradient)
        for i in moved:
            step = np.zeros(len(p))
            step[i] = 1e-6 * np.abs(p[moved]).max()
            central = (quantity.read(p + step) - quantity.read(p - step)) / (2 * step[i])
            assert gradient[i] == pytest.approx(central, rel=1e-5)
