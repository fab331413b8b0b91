"""Pulls against linear fits done anew: priors taken out of the equations, and many draws of a right config."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.uncertainty.nuisance_posterior import WIDER, NuisancePosterior, most_improbable

Reals = NDArray[np.float64]
SOUGHT, NUISANCES, ROWS = 2, 4, 30


@pytest.fixture
def design(rng: np.random.Generator) -> Reals:
    """What the rows show of the unknowns; of the last nuisance next to nothing."""
    design = rng.standard_normal((ROWS, SOUGHT + NUISANCES))
    design[:, 3] = 0.9 * design[:, 2] + 0.3 * design[:, 3]  # two hard to tell apart
    design[:, -1] *= 0.01
    return design


def prior_rows(precision: Reals) -> Reals:
    """Return rows that ask for nuisances of zero, of that inverse covariance (symmetric, may be singular)."""
    size, vectors = np.linalg.eigh(precision)
    return np.pad(np.sqrt(np.maximum(size, 0))[:, None] * vectors.T, ((0, 0), (SOUGHT, 0)))


def fit(design: Reals, y: Reals, precision: Reals) -> tuple[Reals, Reals, float]:
    """Return nuisances, their covariance and chi2 of an ordinary least-squares fit."""
    A, b = np.concatenate([design, prior_rows(precision)]), np.append(y, np.zeros(NUISANCES))
    p = np.linalg.lstsq(A, b, rcond=None)[0]
    return p[SOUGHT:], np.linalg.inv(A.T @ A)[SOUGHT:, SOUGHT:], float(np.sum((A @ p - b) ** 2))


def posterior_of(design: Reals, y: Reals, *, excess: float = 1.0) -> NuisancePosterior:
    x, covariance, _ = fit(design, y, np.eye(NUISANCES))
    return NuisancePosterior(x, covariance, np.eye(NUISANCES), excess)


@pytest.mark.parametrize("direction", [(1.0, 0, 0, 0), (0, 2.0, 0, 0), (1.0, 1.0, 0, 0), (0.5, -1.0, 2.0, 0)])
def test_the_data_alone_say_what_a_fit_without_that_prior_says(
    design: Reals, rng: np.random.Generator, direction: tuple[float, ...]
) -> None:
    y = 3 * rng.standard_normal(ROWS)
    u = np.array(direction) / np.linalg.norm(direction)
    x, covariance, chi2 = fit(design, y, np.eye(NUISANCES) - np.outer(u, u))
    told = posterior_of(design, y).along(np.array(direction))
    assert told.value == pytest.approx(u @ x)
    assert told.sigma == pytest.approx(np.sqrt(u @ covariance @ u))
    assert told.pull**2 == pytest.approx(fit(design, y, np.eye(NUISANCES))[2] - chi2)
    assert np.sign(told.pull) == np.sign(u @ x)


def test_without_a_prior_the_rest_is_as_a_fit_without_it_has_it(design: Reals, rng: np.random.Generator) -> None:
    y = 3 * rng.standard_normal(ROWS)
    u, other = np.array([1.0, 1.0, 0, 0]) / np.sqrt(2), np.array([0, 0, 1.0, 0])
    less = posterior_of(design, y).without_prior(u)
    open_ended = np.eye(NUISANCES) - np.outer(u, u)
    x, covariance, chi2 = fit(design, y, open_ended)
    assert less.x == pytest.approx(x)
    assert less.covariance == pytest.approx(covariance)
    assert less.along(other).pull ** 2 == pytest.approx(chi2 - fit(design, y, open_ended - np.outer(other, other))[2])


def test_a_prior_that_was_wider_is_put_back(design: Reals, rng: np.random.Generator) -> None:
    y = 3 * rng.standard_normal(ROWS)
    wide = np.diag([1.0, 1 / WIDER**2, 1.0, 1.0])
    x, covariance, _ = fit(design, y, wide)
    again = NuisancePosterior(x, covariance, np.eye(NUISANCES)).with_stated_prior(1)
    assert again.x == pytest.approx(posterior_of(design, y).x)
    assert again.covariance == pytest.approx(posterior_of(design, y).covariance)


@pytest.mark.parametrize("excess", [1.0, 4.0])
def test_of_a_right_config_a_pull_squared_is_one_on_average(
    design: Reals, rng: np.random.Generator, excess: float
) -> None:
    """2000 draws: the mean of a squared normal variable is one within 0.03."""
    u, draws = np.array([1.0, -2.0, 0.5, 0]), 2000
    pulls = []
    for _ in range(draws):
        truth = np.append(100 * rng.standard_normal(SOUGHT), rng.standard_normal(NUISANCES))
        y = design @ truth + np.sqrt(excess) * rng.standard_normal(ROWS)
        pulls.append(posterior_of(design, y, excess=excess).along(u).pull)
    assert np.mean(np.square(pulls)) == pytest.approx(1.0, abs=5 * np.sqrt(2 / draws))


def test_what_the_data_do_not_show_is_not_pulled() -> None:
    """The covariance after the fit is the prior's."""
    told = NuisancePosterior(np.array([0.0]), np.eye(1), np.eye(1)).along(np.ones(1))
    assert (told.pull, told.value, told.sigma) == (0.0, 0.0, np.inf)


def measured(values: Reals, variance: float) -> NuisancePosterior:
    """Return what is left of nuisances that were each measured once: value / (1 + variance)."""
    n = len(values)
    return NuisancePosterior(values / (1 + variance), np.eye(n) * variance / (1 + variance), np.eye(n))


def test_evidence_is_the_ratio_of_the_densities_under_both_priors() -> None:
    """A value measured as 6 with variance 0.5: normal of variance 1 + 0.5 against `WIDER` squared + 0.5."""
    narrow, wide = 1.5, WIDER**2 + 0.5
    expected = (36 / narrow + np.log(narrow)) - (36 / wide + np.log(wide))
    assert measured(np.array([6.0]), 0.5).along(np.ones(1)).evidence == pytest.approx(expected)


def test_a_single_wrong_statement_among_right_ones_is_seen() -> None:
    """Of five, one 5 sigmas off: chi2 of 25 with five degrees of freedom is 3.8 sigmas, of one in six tests 4.64."""
    five = measured(np.array([5.0, 0, 0, 0, 0]), 1e-9)
    assert five.joint_pull(list(np.eye(5))) == pytest.approx(4.643, abs=1e-3)


def test_many_a_little_off_are_seen_together() -> None:
    """Each of eight is 2 sigmas off: chi2 of 32, of which one in 10,800 is as large, in the worst of nine tests."""
    eight = measured(np.full(8, 2.0), 1e-9)
    assert eight.joint_pull(list(np.eye(8))) == pytest.approx(3.35, abs=0.02)
    assert most_improbable([(4.0, 1)] * 8) < 2


def test_a_pull_beyond_all_probability_is_still_a_number() -> None:
    assert measured(np.array([100.0, 0.0]), 1e-9).joint_pull(list(np.eye(2))) == pytest.approx(100.0)
