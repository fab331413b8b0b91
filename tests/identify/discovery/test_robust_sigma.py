"""The sandwich's standard deviation of a straight line's slope, beside that of the noise alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rotorrig.identify.discovery.robust_sigma import robust_sigma

ROWS = 240
T = np.linspace(-1.0, 1.0, ROWS)


def line(misfit: np.ndarray) -> tuple[Any, Any]:
    """A problem whose model is a + b t, with a residual that its fit leaves, and that fit."""
    J = np.stack([np.ones(ROWS), T], axis=1)
    r = misfit - J @ np.linalg.lstsq(J, misfit, rcond=None)[0]
    measured = SimpleNamespace(whiten=np.ones((ROWS, 1, 1, 1)), z=np.zeros((ROWS, 1)))
    problem = SimpleNamespace(
        recordings=[SimpleNamespace(measured={1: measured})], jacobian=lambda p: J, residual=lambda p: r
    )
    fit = SimpleNamespace(p=np.zeros(2), sigma=np.sqrt(np.diag(np.linalg.inv(J.T @ J))))
    return problem, fit


def test_where_only_noise_is_left_it_is_the_covariances() -> None:
    ratios = []
    for seed in range(200):
        problem, fit = line(np.random.default_rng(seed).standard_normal(ROWS))
        ratios.append(robust_sigma(problem, fit, 1) / fit.sigma[1])
    assert min(ratios) == 1.0  # never less
    assert np.mean(ratios) == pytest.approx(1.1, abs=0.1)


def test_a_misfit_alike_over_many_rows_is_counted_for_what_it_moves() -> None:
    """Errors of long memory move a slope further than white noise of their size: the scatter over many data is met."""
    rng = np.random.default_rng(1)
    estimates, robust, told = [], [], []
    for _ in range(300):
        misfit = 3.0 * np.repeat(rng.standard_normal(12), ROWS // 12)  # one value for each stretch
        problem, fit = line(misfit)
        estimates.append(np.polyfit(T, misfit, 1)[0])
        robust.append(robust_sigma(problem, fit, 1))
        told.append(fit.sigma[1])
    scatter = np.std(estimates)
    assert scatter > 8 * np.mean(told)
    assert np.mean(robust) == pytest.approx(scatter, rel=0.25)


def test_an_unknown_that_nothing_depends_on_keeps_its_sigma() -> None:
    problem, fit = line(np.ones(ROWS))
    J = problem.jacobian(None) * [1.0, 0.0]
    problem.jacobian = lambda p: J
    assert robust_sigma(problem, fit, 1) == fit.sigma[1]
