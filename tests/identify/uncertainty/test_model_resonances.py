"""Critical speeds of a fitted model against those of rotors drawn from its covariance, each predicted by itself."""

import numpy as np
import pytest

from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty import model_resonances
from rotorrig.processing.resonance import Resonance, find_resonances
from rotorrig.processing.response import OrderTrackedResponse
from tests.identify.problems import problem_of
from tests.identify.swept import C, K

DRAWS = 120
SMALL = 0.03  # of a draw: nearly collinear parameters move far together, and what bends adds up


@pytest.fixture(scope="module")
def fitted(healthy: OrderTrackedResponse) -> Solution:
    """What cannot be below zero is held there: a draw has to be a rotor."""
    problem = problem_of(healthy)
    names = problem.parameters.names
    held = {i: 0.0 for i, name in enumerate(names) if name.startswith(("hub ", "tilt "))}
    return problem.solve(problem.begin(np.array([*K, *C])), fixed=held)


def test_sigmas_are_the_scatter_of_rotors_drawn_from_the_covariance(
    healthy: OrderTrackedResponse, fitted: Solution, rng: np.random.Generator
) -> None:
    problem = problem_of(healthy)
    (recording,) = problem.recordings
    told = {(each.run, each.probe): each.resonance for each in model_resonances(fitted, problem)}
    assert set(told) == {(run.name, probe) for run in healthy.runs for probe in healthy.probes}
    free = np.flatnonzero(np.diag(fitted.covariance))
    sigma = fitted.sigma[free]
    correlation = fitted.covariance[np.ix_(free, free)] / np.outer(sigma, sigma)
    steps = sigma * rng.multivariate_normal(np.zeros(len(free)), correlation, DRAWS, method="svd")
    drawn: dict[tuple[str, str], list[Resonance]] = {place: [] for place in told}
    for step in steps:
        p = fitted.p.copy()
        p[free] += SMALL * step
        p[problem.parameters.base.runout] = 0.0
        (z,) = problem.model.predict(p, orders=(1,))
        for i, run in enumerate(healthy.runs):
            rows = healthy.run[recording.rows] == i
            for n, probe in enumerate(healthy.probes):
                curve = healthy.omega[recording.rows][rows], z[1][:-1][rows, n]
                (found,) = find_resonances(*curve, rate=healthy.rate(i))
                drawn[run.name, probe].append(found)
    for place, mine in told.items():
        assert mine.damping is not None
        for name in ("omega", "amplitude", "damping"):
            values = np.array([getattr(each, name).value for each in drawn[place]])
            stated = getattr(mine, name)
            assert SMALL * stated.sigma == pytest.approx(values.std(), rel=0.25), (place, name)  # 4 standard errors
            assert stated.value == pytest.approx(values.mean(), abs=SMALL * stated.sigma), (place, name)


def test_a_fit_without_phases_states_none(healthy: OrderTrackedResponse, fitted: Solution) -> None:
    problem = problem_of(healthy)
    problem.model.amplitudes_alone = True
    assert model_resonances(fitted, problem) == ()
