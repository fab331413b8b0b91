"""Counts from the values of an openDAQ channel: the converter's own, or rounded volts."""

import numpy as np
import pytest

from rotorrig.rig.probes.opendaq.counts import FULL_SCALE, raw_scale, rounded_scale


def test_offset_binary_counts_become_signed_ones_exactly() -> None:
    scale = raw_scale(np.dtype("uint16"), scale=20 / 65536, offset=-10.0, volts=(-10.0, 10.0))
    assert scale.volts_per_count == 20 / 65536
    assert scale.counts(np.array([0, 32768, 65535], dtype=np.uint16)).tolist() == [-32768, 0, 32767]
    assert (scale.lowest, scale.highest, scale.full_scale) == (-32768, 32767, 32768)
    assert scale.remark == "raw counts of 305.2 uV"


def test_an_inverting_input_has_its_sign_turned() -> None:
    scale = raw_scale(np.dtype("int16"), scale=-1e-3, offset=0.0, volts=None)
    assert scale.volts_per_count == 1e-3
    assert scale.counts(np.array([5, -32768], dtype=np.int16)).tolist() == [-5, 32768]
    assert (scale.lowest, scale.highest) == (-32767, 32768)


def test_an_offset_between_two_counts_is_said() -> None:
    scale = raw_scale(np.dtype("int32"), scale=1e-3, offset=0.0104, volts=None)
    assert scale.counts(np.array([0], dtype=np.int32)).tolist() == [10]  # 0.0104 V
    assert scale.remark == "raw counts of 1000 uV, 400 uV are left out"


def test_a_unipolar_range_has_its_own_ends() -> None:
    scale = raw_scale(np.dtype("int16"), scale=1e-3, offset=0.0, volts=(0.0, 5.0))
    assert (scale.lowest, scale.highest, scale.full_scale) == (0, 5000, 5001)


def test_volts_are_rounded_to_24_bits_of_the_range() -> None:
    scale = rounded_scale(volts=(-10.0, 10.0))
    step = 10 / 2**23
    assert scale.volts_per_count == step
    volts = np.array([0.0, 0.4 * step, 0.6 * step, -3.2 * step, 10.0, -10.0, 11.0, -11.0])
    full = FULL_SCALE
    assert scale.counts(volts).tolist() == [0, 0, 1, -3, full - 1, -full, full - 1, -full]
    assert scale.remark == "the device gives volts, not counts; they are rounded to steps of 1.192 uV"


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_what_is_no_number_reads_as_the_end_of_the_range(kind: type) -> None:
    scale = rounded_scale(volts=(-10.0, 5.0))
    counts = scale.counts(np.array([np.nan, np.inf, -np.inf], dtype=kind))
    assert counts.tolist() == [scale.lowest, scale.highest, scale.lowest]
    assert counts.dtype == np.int32
