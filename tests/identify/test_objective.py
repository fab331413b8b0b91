"""The chapter's objectives, eq. (14)-(16), on numbers worked by hand."""

import numpy as np
import pytest

from rotorrig.identify.objective import f1, f2, f3

MEASURED = np.array([[100e-6, 10e-6], [np.nan, 1e-6]])  # m, (speed, probe)
PREDICTED = np.array([[[110e-6, 10e-6], [5e-6, 0.1e-6]], [[1000e-6, 100e-6], [5e-6, 10e-6]]])  # two candidates


def test_f1_sums_squares_in_square_micrometres() -> None:
    assert f1(MEASURED, PREDICTED) == pytest.approx([10**2 + 0.9**2, 900**2 + 90**2 + 9**2])


def test_f2_sums_decades() -> None:
    assert f2(MEASURED, PREDICTED) == pytest.approx([np.log10(1.1) + 1, 3.0])


def test_f3_sums_micrometres() -> None:
    assert f3(MEASURED, PREDICTED) == pytest.approx([10.9, 999.0])
