"""Counts become metres by the nameplate's straight line; the inverse is written here."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.probes.base import DaqInfo
from rotorrig.rig.probes.calibration import ProbeScale, channel_volts, channels_used

BITS = DaqInfo(
    model="d",
    serial="",
    sample_rate=1e4,
    channels=5,
    volts_per_count=(1e-3, 2e-3, 1e-3, 1e-3, 1e-3),
    full_scale_counts=32768,
)


def test_a_probe_at_its_gap_voltage_reads_zero(rk4: RigConfig) -> None:
    counts = np.array([[-10_000, -5_000, -10_000, -10_000, 0]], dtype=np.int32)  # -10 V on each
    np.testing.assert_allclose(ProbeScale.of(rk4, BITS).displacement(counts), 0, atol=1e-15)


def test_volts_rise_as_the_shaft_comes_nearer(rk4: RigConfig) -> None:
    # 7.874 V/mm: 0.7874 V above the gap voltage are 100 um towards the probe, on the 2 mV channel in half the counts
    counts = np.array([[-10_000 + 787, -5_000 + 394, -10_000, -10_000, 0]], dtype=np.int32)
    metres = ProbeScale.of(rk4, BITS).displacement(counts)
    np.testing.assert_allclose(metres[0, :2], [0.787 / 7874, 0.788 / 7874], rtol=1e-12)


@given(wanted=st.lists(st.floats(-1e-3, 1e-3), min_size=4, max_size=4))
def test_what_the_inverse_makes_is_read_back_within_a_count(rk4: RigConfig, wanted: list[float]) -> None:
    per_count = np.array(BITS.volts_per_count)
    in_counts = np.round((-10.0 + 7874.0 * np.array([*wanted, 0.0])) / per_count).astype(np.int32)
    metres = ProbeScale.of(rk4, BITS).displacement(in_counts[None])[0]
    np.testing.assert_array_less(np.abs(metres - wanted), per_count[:4] / 7874 / 2 * 1.0001)


def test_columns_follow_the_configs_order_and_not_the_channels(rk4: RigConfig) -> None:
    swapped = rk4.model_copy(update={"probes": rk4.probes[::-1]})
    counts = np.arange(10, dtype=np.int32).reshape(2, 5)
    np.testing.assert_array_equal(
        ProbeScale.of(swapped, BITS).displacement(counts), ProbeScale.of(rk4, BITS).displacement(counts)[:, ::-1]
    )
    assert ProbeScale.of(swapped, BITS).names == ("2y", "2x", "1y", "1x")


def test_volts_are_counts_times_the_channels_step() -> None:
    counts = np.array([[1, 1, 1, 1, -8000], [2, 3, 4, 5, 6]], dtype=np.int32)
    np.testing.assert_allclose(channel_volts(counts, channel=1, info=BITS), [2e-3, 6e-3])
    np.testing.assert_allclose(channel_volts(counts, channel=4, info=BITS), [-8.0, 6e-3])


def test_the_highest_channel_of_the_config_is_the_keyphasors(rk4: RigConfig) -> None:
    assert channels_used(rk4) == 5
    assert channels_used(rk4.model_copy(update={"keyphasor": None})) == 4


def test_a_config_that_needs_more_channels_is_refused(rk4: RigConfig) -> None:
    small = DaqInfo(
        model="small", serial="", sample_rate=1e4, channels=4, volts_per_count=(1e-3,) * 4, full_scale_counts=32768
    )
    with pytest.raises(ConfigError, match=r"channel 4: the DAQ 'small' has 4 channels, want one with at least 5"):
        ProbeScale.of(rk4, small)
