"""The order of a signal's path: where a probe looks changes no hum of its cable, a late recording has it late too."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.causes.score_jacobian import score_columns
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import MainsHum, OrderTrackedResponse
from rotorrig.sims.effects.base import find

HUM = 2e-6  # m
ON_PROBES = {"probe_angle, probe 2x": {"turn": 0.3}, "cross_talk, plane 1": {"leak": 0.1}}
ON_RECORDED = {"delay, probe 1y": {"delay": 1e-3}}
Thetas = dict[str, dict[str, float]]


@pytest.fixture(scope="module")
def humming(short: OrderTrackedResponse) -> OrderTrackedResponse:
    steady = MainsHum(frequency=50.0, t=short.t[[0, -1]], stray=np.zeros(2), shares=np.ones(4, complex))
    return replace(short, mains=(steady,))


def problem_with(
    response: OrderTrackedResponse, thetas: Thetas, hidden: np.ndarray
) -> tuple[ExtendedProblem, np.ndarray]:
    effects = [find(response.rig, label) for label in thetas]
    problem = ExtendedProblem(ExtendedModel([Recording(response)], effects))
    names, p = problem.parameters, problem.parameters.start(hidden)
    p[names.hums.start] = HUM
    values = [theta[q.name] / q.size for e, theta in zip(effects, thetas.values(), strict=True) for q in e.parameters]
    p[names.own.stop - len(values) : names.own.stop] = values
    return problem, p


def hum_seen(problem: ExtendedProblem, p: np.ndarray) -> dict[int, np.ndarray]:
    without = p.copy()
    without[problem.parameters.hums] = 0.0
    quiet = problem.model.predict(without)[0]
    return {order: z - quiet[order] for order, z in problem.model.predict(p)[0].items()}


def test_hum_is_what_it_is_wherever_the_probes_look(humming: OrderTrackedResponse, hidden: np.ndarray) -> None:
    turned, plain = (hum_seen(*problem_with(humming, thetas, hidden)) for thetas in (ON_PROBES, {}))
    assert np.abs(plain[2]).max() > 0.1e-6
    for order, hum in turned.items():
        assert hum == pytest.approx(plain[order], abs=1e-15)


def test_of_what_is_recorded_late_the_hum_is_late(humming: OrderTrackedResponse, hidden: np.ndarray) -> None:
    late, plain = (hum_seen(*problem_with(humming, thetas, hidden)) for thetas in (ON_RECORDED, {}))
    lag = np.outer(humming.omega, [name == "1y" for name in humming.probes]) * 1e-3
    for order, hum in late.items():
        assert hum[:-1] == pytest.approx(plain[order][:-1] * np.exp(-1j * order * lag), abs=1e-13)


def test_the_jacobian_has_the_path_in_it(humming: OrderTrackedResponse, hidden: np.ndarray) -> None:
    problem, p = problem_with(humming, ON_PROBES | ON_RECORDED, hidden)
    names = problem.parameters
    which = np.array([names.hums.start, names.hums.start + 1, *range(names.own.stop - 3, names.own.stop)])
    for column, i in zip(problem.jacobian(p, which).T, which, strict=True):
        h = 1e-9 if i < names.hums.stop else 1e-4
        ahead, behind = p.copy(), p.copy()
        ahead[i] += h
        behind[i] -= h
        expected = (problem.residual(ahead) - problem.residual(behind)) / (2 * h)
        assert column == pytest.approx(expected, rel=1e-3, abs=1e-3 * np.abs(expected).max()), names.names[i]


@pytest.mark.parametrize("label", ["probe_gain, probe 2x", "delay, probe 2x"])
def test_a_score_has_the_path_in_it(label: str, humming: OrderTrackedResponse, hidden: np.ndarray) -> None:
    """Beside a turned probe and a late one, at a fit with hum: the column is the larger problem's own."""
    thetas = ON_PROBES | ON_RECORDED
    problem, p = problem_with(humming, thetas, hidden)
    effect = find(humming.rig, label)
    (column,) = score_columns(problem, p, [effect])
    larger, there = problem_with(humming, {**thetas, label: effect.at_zero}, hidden)
    expected = larger.jacobian(there, np.array([larger.parameters.own.stop - 1]))
    np.testing.assert_allclose(column, expected, rtol=0, atol=2e-3 * np.abs(expected).max())
