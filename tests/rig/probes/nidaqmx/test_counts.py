"""NI's raw integers and their calibration polynomial: handed on where it is a slope, applied where it is more."""

import numpy as np
import pytest

from rotorrig.rig.probes.nidaqmx.counts import linearise

LSB = 20 / 65536  # V: 16 bits over -10 V to 10 V
RAW = np.arange(-32768, 32768, dtype=np.int32)


def test_a_pure_slope_leaves_the_counts_alone() -> None:
    scale = linearise((0.0, LSB), low=-10.0, high=10.0)
    assert scale.is_raw
    assert scale.counts(RAW) is RAW
    assert (scale.volts_per_count, scale.lowest, scale.highest) == (LSB, -32768, 32767)
    assert scale.remark == "raw counts of 305.2 uV"


def test_higher_terms_below_a_hundredth_of_a_count_are_a_slope() -> None:
    cubic = 0.005 * LSB / 32768**3
    assert linearise((0.004 * LSB, LSB, 0.0, cubic), low=-10.0, high=10.0).is_raw
    assert not linearise((0.004 * LSB, LSB, 0.0, 2 * cubic), low=-10.0, high=10.0).is_raw


COEFFICIENTS = (-2.3e-4, 3.2e-4, 3e-14, -2e-19)  # as of an M series device of 16 bits at 10 V


def test_a_polynomial_is_applied_to_within_a_32nd_of_a_count() -> None:
    scale = linearise(COEFFICIENTS, low=-10.0, high=10.0)
    assert not scale.is_raw
    a, b, c, d = COEFFICIENTS
    x = RAW.astype(float)
    volts = a + b * x + c * x**2 + d * x**3
    counts = scale.counts(RAW)
    assert counts.dtype == np.int32
    np.testing.assert_allclose(counts * scale.volts_per_count, volts, atol=b / 32 * 1.0001)
    assert len(np.unique(counts)) == len(RAW)  # no raw value is lost
    assert scale.remark == ("raw counts linearised by the device's calibration polynomial, in steps of 20 uV")


def test_the_ends_are_those_of_the_range() -> None:
    scale = linearise(COEFFICIENTS, low=-10.0, high=10.0)
    assert scale.lowest * scale.volts_per_count == pytest.approx(-10.0, abs=2e-5)
    assert scale.highest * scale.volts_per_count == pytest.approx(10.0, abs=2e-5)


def test_offset_binary_is_moved_to_zero_volts() -> None:
    scale = linearise((-31.157441, 0.000638), low=-20.0, high=20.0)  # of a USB-6009
    counts = scale.counts(np.array([0, 48836, 65535], dtype=np.int32))
    np.testing.assert_allclose(counts * scale.volts_per_count, [-31.157441, -0.000073, 10.653889], atol=2e-5)


def test_a_falling_slope_is_turned() -> None:
    scale = linearise((0.0, -LSB), low=-10.0, high=10.0)
    assert scale.volts_per_count == LSB / 16
    assert scale.counts(np.array([100], dtype=np.int32)).tolist() == [-1600]


def test_fine_converters_keep_within_32_bits() -> None:
    step = 20 / 2**31
    scale = linearise((1e-6, step), low=-10.0, high=10.0)
    assert scale.volts_per_count == step
    assert scale.counts(np.array([2**30 - 1], dtype=np.int32))[0] == pytest.approx(2**30 - 1 + 1e-6 / step, abs=1)


@pytest.mark.parametrize("coefficients", [(0.0, 0.0), (1.0,), (0.0, float("nan"))])
def test_coefficients_without_a_slope_are_refused(coefficients: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="want a slope that is not zero"):
        linearise(coefficients, low=-10.0, high=10.0)
