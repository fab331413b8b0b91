"""Density that a fitted model gives to what it never saw."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from rotorrig.identify.extended_model import ExtendedModel, ExtendedProblem, Recording
from rotorrig.identify.verdict.part_fits import PartFits
from rotorrig.identify.verdict.predictive_density import block_deviances, deviance
from rotorrig.rig.config import RPM, RigConfig
from tests.identify.swept import DRAWN, swept_response

PEAK = 2230 / RPM  # rad/s


def test_the_deviance_is_that_of_a_normal_density_with_noise_and_spread() -> None:
    rng = np.random.default_rng(52)
    off, spread = rng.normal(size=7), 3 * rng.normal(size=(7, 4))
    density = multivariate_normal(np.zeros(7), np.eye(7) + spread @ spread.T).logpdf(off)
    assert deviance(off, spread) == pytest.approx(-2 * density - 7 * np.log(2 * np.pi))


def test_a_direction_left_open_costs_its_width_and_not_the_error_along_it() -> None:
    open_ = np.array([[1e8], [0.0]])
    near, far = (deviance(np.array([along, 2.0]), open_) for along in (0.0, 1e4))
    assert near == pytest.approx(4.0 + 2 * np.log(1e8))
    assert far == pytest.approx(near, rel=1e-6)


def test_no_direction_left_open_leaves_the_squared_error() -> None:
    assert deviance(np.array([3.0, 4.0]), np.zeros((2, 0))) == 25.0


def test_what_is_left_open_of_a_hidden_resonance_is_in_the_density(rig: RigConfig, hidden: np.ndarray) -> None:
    """Over draws of the noise the right model errs by what was drawn; held against the noise alone, by far more."""
    within = alone = figures = 0.0
    for draw in range(6):
        recording = Recording(swept_response(rig, rng=np.random.default_rng(5200 + draw)))
        problem = ExtendedProblem(ExtendedModel([recording]))
        fit = problem.solve(problem.parameters.start(hidden))
        near = np.abs(recording.response.omega[recording.rows] / PEAK - 1) < 0.2
        fits, unseen = PartFits(problem, fit.p), problem.on([recording.only(near)])
        shown = fits.fit([recording.only(~near)])
        vectors, spread = shown.problem.model.predict(shown.p), fits.spread(unseen, shown)
        exact = [{n: m.z for n, m in unseen.recordings[0].measured.items()}]
        within += (block_deviances(unseen, vectors, spread) - block_deviances(unseen, exact, spread)).sum()
        alone += block_deviances(unseen, vectors, np.zeros((len(spread), 0))).sum()
        figures += 2 * sum(int(m.usable[:-1].sum()) for m in unseen.recordings[0].measured.values())
    tolerance = 4 * np.sqrt(2 / figures)
    still = 6 * spread.shape[1] / figures  # at most: nuisances are not drawn from their priors, but at their means
    assert (1 - still) * (1 - tolerance) < within / figures / DRAWN**2 < 1 + tolerance
    assert alone / figures / DRAWN**2 > 10
