"""Uncertainty of a table's vectors: found in their scatter, or stated, and never zero."""

import numpy as np
import pytest

from rotorrig.processing.files.bode_table_noise import scatter_variance
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.processing.files.test_bode_table import PLAIN, STATED, Files


@pytest.fixture
def files(tmp_path, rk4: RigConfig) -> Files:
    return Files(tmp_path, rk4)


def test_scatter_about_a_smooth_curve_is_found_and_outliers_are_not(rng: np.random.Generator) -> None:
    r = np.linspace(0.5, 1.5, 600)
    smooth = r**2 / (1 - r**2 + 0.2j * r)
    z = smooth + 0.01 * (rng.standard_normal(600) + 1j * rng.standard_normal(600))
    z[100], z[300] = 50.0, np.nan
    sigma = np.sqrt(scatter_variance(z))
    assert np.median(sigma) == pytest.approx(0.01, rel=0.08)
    assert sigma.max() < 0.02 and sigma.min() > 0.005
    quieter = np.sqrt(scatter_variance(smooth + 0.1 * (z - smooth)))
    assert np.median(quieter) == pytest.approx(0.001, rel=0.08)


def test_rows_that_repeat_to_the_last_digit_want_a_stated_uncertainty(files: Files) -> None:
    table = "rpm,amp,phase\n" + "".join(f"{1000 + 10 * i},5,-30\n" for i in range(30))
    with pytest.raises(DataError, match=r"do not scatter at all, .* want \[uncertainty\] in the mapping"):
        files.read(mapping=PLAIN.replace(STATED, ""), table=table)
    assert files.read(table=table).usable[:, 0].all()


def test_a_zero_with_nothing_but_a_relative_uncertainty_is_no_measurement(files: Files) -> None:
    relative = PLAIN.replace('absolute = "1 um"', "relative = 0.02")
    response = files.read(mapping=relative, table="rpm,amp,phase\n1000,10,0\n1010,0,0\n1020,10,0\n")
    np.testing.assert_array_equal(response.usable[:, 0], [True, False, True])
    assert response.reasons[1][0] == "1x: an amplitude of 0 without an absolute uncertainty"
    assert response.reasons[0] == ("1y: not in the table", "2x: not in the table", "2y: not in the table")


def test_a_stated_slow_roll_is_as_uncertain_as_the_median_of_the_rows_that_have_a_value(files: Files) -> None:
    stated = '[slow_roll]\nspeed = "300 rpm"\nvectors = [{ probe = "1x", amplitude = "4 um", phase = "90 deg" }]\n'
    response = files.read(mapping=PLAIN + stated, table="rpm,amp,phase\n1000,10,0\n1010,,\n1020,10,0\n")
    assert response.slow_roll_covariance[0, 0, 0] == pytest.approx(1e-12)
    assert np.isnan(response.slow_roll_covariance[0, 2, 2]), "of a probe that the table lacks nothing is known"
