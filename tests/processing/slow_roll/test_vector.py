"""The slow-roll vector: mean, covariance, and what speaks against it."""

import numpy as np
import pytest

from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.rig.errors import DataError

TRUE = np.array([[3e-6 + 1e-6j, 0.5e-6j], [-2e-6, 1e-7]])  # (probe, order)
SIGMA = 1e-8


def dwell(rng: np.random.Generator, rows: int, *, spread: float = SIGMA) -> tuple[np.ndarray, np.ndarray]:
    z = TRUE + spread * (rng.standard_normal((rows, 2, 2)) + 1j * rng.standard_normal((rows, 2, 2)))
    return z, np.tile(SIGMA**2 * np.eye(4), (rows, 2, 1, 1))


def test_it_is_the_mean_and_as_certain_as_a_mean(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 25)
    found = slow_roll.estimate(z, covariance, np.full(25, 25.0), usable=np.ones((25, 2), dtype=bool))
    np.testing.assert_allclose(found.z, TRUE, atol=5 * SIGMA / 5)
    np.testing.assert_allclose(np.sqrt(found.covariance[0, 0, 0]), SIGMA / 5, rtol=0.5)
    assert found.omega == pytest.approx(25.0)
    assert found.remarks == ()


def test_rows_that_scatter_more_than_their_noise_make_it_less_certain(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 25, spread=10 * SIGMA)
    found = slow_roll.estimate(z, covariance, np.full(25, 25.0), usable=np.ones((25, 2), dtype=bool))
    assert np.sqrt(found.covariance[0, 0, 0]) == pytest.approx(10 * SIGMA / 5, rel=0.3)
    assert "scatter" in found.remarks[0]


def test_a_speed_that_does_not_dwell_is_said(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 25)
    found = slow_roll.estimate(z, covariance, np.linspace(25, 27, 25), usable=np.ones((25, 2), dtype=bool))
    assert found.remarks == ("the speed varies by 7.7% during the slow roll, want less than 2%",)


def test_rows_of_a_ramp_scatter_about_what_grows_with_the_square_of_speed(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 40)
    omega = np.linspace(20, 60, 40)
    usable = np.ones((40, 2), dtype=bool)
    ramp = z + 2e-6 * (omega[:, None, None] / 60) ** 2
    found = slow_roll.estimate(ramp, covariance, omega, usable=usable, dwell=False)
    assert found.remarks == ()
    assert np.sqrt(found.covariance[0, 0, 0]) == pytest.approx(SIGMA / np.sqrt(40), rel=0.3)
    assert "scatter" in slow_roll.estimate(ramp, covariance, omega, usable=usable).remarks[1]


def test_its_speed_is_where_a_response_to_unbalance_has_its_mean() -> None:
    omega = np.array([20.0, 30.0, 60.0])
    z = np.tile(1e-9 * omega[:, None, None] ** 2, (1, 2, 2)).astype(complex)
    covariance = np.tile(SIGMA**2 * np.eye(4), (3, 2, 1, 1))
    found = slow_roll.estimate(z, covariance, omega, usable=np.ones((3, 2), dtype=bool), dwell=False)
    np.testing.assert_allclose(found.z, 1e-9 * found.omega**2)


def test_unusable_rows_are_left_out(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 25)
    usable = np.ones((25, 2), dtype=bool)
    z[3], usable[3] = 1.0, (True, False)
    found = slow_roll.estimate(z, covariance, np.full(25, 25.0), usable=usable)
    np.testing.assert_allclose(found.z, TRUE, atol=5 * SIGMA)
    assert found.used.tolist() == [row != 3 for row in range(25)]
    assert np.isnan(slow_roll.estimate(z, covariance, np.full(25, 25.0), usable=np.zeros((25, 2), dtype=bool)).omega)


def test_a_probe_without_any_value_leaves_the_others_theirs(rng: np.random.Generator) -> None:
    z, covariance = dwell(rng, 25)
    z[:, 1] = np.nan
    found = slow_roll.estimate(z, covariance, np.full(25, 25.0), usable=np.tile([True, False], (25, 1)))
    np.testing.assert_allclose(found.z[0], TRUE[0], atol=5 * SIGMA)
    assert np.isnan(found.z[1]).all()


def test_subtracting_and_restoring_gives_the_raw_vectors_back(rng: np.random.Generator) -> None:
    z, _ = dwell(rng, 4)
    before = z.copy()
    compensated = slow_roll.subtract(z, TRUE)
    np.testing.assert_allclose(np.abs(compensated), np.abs(z - TRUE))
    np.testing.assert_allclose(slow_roll.restore(compensated, TRUE), z, rtol=1e-12)
    np.testing.assert_array_equal(z, before)


def test_nothing_is_subtracted_where_there_is_no_slow_roll(rng: np.random.Generator) -> None:
    z, _ = dwell(rng, 4)
    with pytest.raises(DataError, match="no slow-roll vector to subtract"):
        slow_roll.subtract(z, slow_roll.none(probes=2, orders=2).z)
