"""Scatter from row to row is the noise, whatever smooth misfit is under it."""

import numpy as np
import pytest

from rotorrig.identify.adequacy.row_scatter import excess_scatter, local_excess, row_variance

ROWS = 2_000
RUN = np.repeat([0, 1], ROWS // 2)
SMOOTH = 20 * np.sin(np.linspace(0, 12, ROWS))[:, None]


def test_it_is_the_variance_of_noise_under_a_misfit_twenty_times_as_large(rng: np.random.Generator) -> None:
    noise = 1.5 * rng.standard_normal((ROWS, 4))
    assert row_variance(noise + SMOOTH, RUN) == pytest.approx(1.5**2, rel=0.1)


def test_rows_of_two_runs_are_no_neighbours() -> None:
    values = np.where(RUN == 0, 0.0, 1e3)[:, None]
    assert row_variance(values, RUN) == 0.0


def test_what_was_not_measured_has_no_say(rng: np.random.Generator) -> None:
    values = rng.standard_normal((ROWS, 2))
    values[::3, 1] = np.nan
    assert row_variance(values, RUN) == pytest.approx(1.0, rel=0.15)
    assert np.isnan(row_variance(np.full((5, 2), np.nan), np.zeros(5, dtype=int)))


def test_a_run_that_scatters_more_than_stated_is_louder_and_the_other_stays(rng: np.random.Generator) -> None:
    values = rng.standard_normal((ROWS, 4)) * np.where(RUN == 0, 0.5, 2.0)[:, None] + SMOOTH
    factor = excess_scatter(values, RUN)
    assert (factor[RUN == 0] == 1.0).all(), "it is never less"
    assert factor[RUN == 1] == pytest.approx(4.0, rel=0.15)


def test_the_few_rows_of_a_narrow_misfit_do_not_make_it_louder(rng: np.random.Generator) -> None:
    values = rng.standard_normal((ROWS, 4))
    values[500:520] += 1e3 * rng.standard_normal((20, 4))
    assert excess_scatter(values, RUN)[0] < 1.15
    assert (excess_scatter(values[:9] * 5, np.zeros(9, dtype=int)) == 1.0).all(), "nine rows do not tell"


def test_noise_that_is_louder_here_is_louder_here_and_a_smooth_bump_is_not(rng: np.random.Generator) -> None:
    noise = (rng.standard_normal(ROWS) + 1j * rng.standard_normal(ROWS)) / np.sqrt(2)
    here, there = np.arange(400, 600), np.arange(1000, 1200)
    bump = 3 * np.exp(-(((np.arange(ROWS) - 1100) / 20) ** 2))
    white = noise * np.where(np.isin(np.arange(ROWS), here), 3.0, 1.0) + bump
    assert local_excess(white, here, around=0) == pytest.approx(9.0, rel=0.3)
    assert local_excess(white, there, around=0) == pytest.approx(1.0, rel=0.3)
    assert local_excess(0.1 * noise, here, around=0) == 1.0, "it is never less"
    assert local_excess(9 * noise[:7], np.arange(7), around=0) == 1.0, "seven rows do not tell"


def test_noise_that_rings_is_as_loud_as_it_is_by_rows_further_apart(rng: np.random.Generator) -> None:
    noise = rng.standard_normal(ROWS + 2) + 1j * rng.standard_normal(ROWS + 2)
    ringing = 3 * np.convolve(noise, np.ones(3), "valid") / np.sqrt(6)  # neighbours have two of three in common
    rows = np.arange(400, 1200)
    assert local_excess(ringing, rows, around=0, apart=3) == pytest.approx(9.0, rel=0.2)
    assert local_excess(ringing, rows, around=0) == pytest.approx(3.0, rel=0.2)
