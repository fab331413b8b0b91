import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.sensors.chain import make_chain
from rotorrig.sims.plant.sensors.channels import VOLTS_PER_COUNT, Sensors, apply_curvature
from rotorrig.sims.plant.truth import Noise, Truth

RATE = 10_000.0
SENSITIVITY = 7874.0  # V/m


def volts(rig: RigConfig, truth: Truth, motion: NDArray[np.float64], theta: NDArray[np.float64]) -> NDArray[np.float64]:
    return Sensors(rig, truth, make_chain(rig, truth), sample_rate=RATE).counts(motion, theta) * VOLTS_PER_COUNT


def still(rig: RigConfig, samples: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return no motion at half a turn from the keyphasor's edge."""
    return np.zeros((samples, len(rig.probes), 2)), np.full(samples, math.pi)


def test_a_probe_s_volts_rise_as_the_shaft_comes_nearer(rk4: RigConfig) -> None:
    motion, theta = still(rk4, 1)
    motion[0, :] = (100e-6, -50e-6)
    got = volts(rk4, nameplate(rk4), motion, theta)[0, :4]
    nearer = -10.0 + SENSITIVITY * np.array([100e-6, -50e-6, 100e-6, -50e-6])
    assert got == pytest.approx(nearer, abs=VOLTS_PER_COUNT / 2)


def test_gain_and_angle_errors_tilt_and_scale_a_probe(rk4: RigConfig) -> None:
    motion, theta = still(rk4, 1)
    motion[0, :] = (100e-6, 40e-6)
    truth = replace(nameplate(rk4), probe_gain_factors=(1.02, 1, 1, 1), probe_angle_errors=(0.01, 0, 0, 0))
    expected = -10.0 + SENSITIVITY * 1.02 * (100e-6 * math.cos(0.01) + 40e-6 * math.sin(0.01))
    assert volts(rk4, truth, motion, theta)[0, 0] == pytest.approx(expected, abs=VOLTS_PER_COUNT / 2)


def test_the_scale_factor_is_off_as_its_calibration_table_says() -> None:
    """Off the middle by 1 at 300 um, 1.22 at 450, 1.5 at 900 um; spread beyond the target by 1, 1.7 and 2.8."""
    assert apply_curvature(3e-4, 0.002, 0.001) == pytest.approx(3e-4 * 1.003)
    assert apply_curvature(-3e-4, 0.002, 0.001) == pytest.approx(-3e-4 * 0.999)
    assert apply_curvature(9e-4, 0.002, 0.001) == pytest.approx(9e-4 * 1.0058)
    assert apply_curvature(-3.75e-4, 0.002, 0.001) == pytest.approx(-3.75e-4 * (1 - 0.00222 + 0.00135))
    assert apply_curvature(5e-3, 0.002, 0.0) == pytest.approx(5e-3 * 1.0031)  # past its end as at its end
    assert apply_curvature(0.0, 0.002, 0.001) == 0.0


@pytest.mark.parametrize("offset", [0.0, 0.03, -0.05])
def test_the_falling_edge_s_middle_is_at_the_keyphasor_s_offset(rk4: RigConfig, offset: float) -> None:
    theta = 4 * np.pi + np.radians(np.arange(-180.0, 180.0, 0.01))
    truth = replace(nameplate(rk4), keyphasor_offset=offset)
    wave = volts(rk4, truth, np.zeros((len(theta), 4, 2)), theta)[:, rk4.keyphasor.channel]
    falling = np.flatnonzero((wave[:-1] > -13.0) & (wave[1:] <= -13.0))
    rising = np.flatnonzero((wave[:-1] < -13.0) & (wave[1:] >= -13.0))
    assert theta[falling] - 4 * np.pi == pytest.approx([offset], abs=math.radians(0.02))
    assert theta[rising] - 4 * np.pi == pytest.approx([offset + math.radians(20.0)], abs=math.radians(0.02))


def test_the_last_of_several_notches_comes_a_quarter_of_a_spacing_early(rk4: RigConfig) -> None:
    """So the first, at the keyphasor's offset, is the one after the widest spacing."""
    theta = 4 * np.pi + np.radians(np.arange(-5.0, 355.0, 0.01))
    rig = rk4.model_copy(update={"keyphasor": rk4.keyphasor.model_copy(update={"pulses_per_revolution": 6})})
    wave = volts(rig, nameplate(rig), np.zeros((len(theta), 4, 2)), theta)[:, rig.keyphasor.channel]
    falling = np.degrees(theta[np.flatnonzero((wave[:-1] > -13.0) & (wave[1:] <= -13.0))]) - 720
    assert falling == pytest.approx([0.0, 60.0, 120.0, 180.0, 240.0, 285.0], abs=0.02)
    assert wave.min() == pytest.approx(-16.0, abs=0.01)
    assert wave.max() == pytest.approx(-10.0, abs=0.01)


def test_a_keyphasor_on_its_rising_edge_has_that_one_at_angle_zero(rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"keyphasor": rk4.keyphasor.model_copy(update={"edge": "rising"})})
    theta = np.radians(np.arange(-180.0, 180.0, 0.01))
    wave = volts(rig, nameplate(rig), np.zeros((len(theta), 4, 2)), theta)[:, 4]
    rising = np.flatnonzero((wave[:-1] < -13.0) & (wave[1:] >= -13.0))
    assert theta[rising] == pytest.approx([0.0], abs=math.radians(0.02))


def phasor(wave: NDArray[np.float64], theta: NDArray[np.float64], n: int) -> NDArray[np.complex128]:
    return 2 * np.mean(wave * np.exp(-1j * n * theta)[:, None], axis=0)


def test_the_two_probes_of_a_plane_see_one_track_a_quarter_turn_apart(rk4: RigConfig) -> None:
    theta = np.linspace(0.0, 2 * np.pi, 20_000, endpoint=False)
    truth = replace(nameplate(rk4), runout_seed=5)
    wave = volts(rk4, truth, np.zeros((len(theta), 4, 2)), theta)[:, :4] / SENSITIVITY
    for n in (1, 2, 3, 4, 5):
        x1, y1, x2, y2 = phasor(wave, theta, n)
        assert abs(y1 - (-1j) ** n * x1) < 0.42e-6  # the electrical part, 0.2 um in each
        assert abs(y2 - (-1j) ** n * x2) < 0.42e-6
    first = np.abs(phasor(wave, theta, 1))
    assert (first > 1.7e-6).all()
    assert (first < 5.3e-6).all()
    assert abs(first[0] - first[2]) > 1e-8  # two planes, two tracks


def test_rotation_the_other_way_brings_the_track_to_y_first(rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"rotation": "y-to-x"})
    theta = np.linspace(0.0, 2 * np.pi, 20_000, endpoint=False)
    truth = replace(nameplate(rig), runout_seed=5)
    x, y = phasor(volts(rig, truth, np.zeros((len(theta), 4, 2)), theta)[:, :2] / SENSITIVITY, theta, 1)
    assert abs(y - 1j * x) < 0.42e-6


def test_noise_is_white_and_as_large_as_its_level(rk4: RigConfig) -> None:
    truth = replace(nameplate(rk4), noise=replace(Noise.none(), probe=1.5e-3, keyphasor=5e-3))
    wave = volts(rk4, truth, *still(rk4, 50_000))
    assert wave.std(axis=0) == pytest.approx([1.5e-3] * 4 + [5e-3], rel=0.03)
    spectrum = np.abs(np.fft.rfft(wave[:, 0] - wave[:, 0].mean())) ** 2
    assert spectrum[1:12_500].sum() == pytest.approx(spectrum[12_500:].sum(), rel=0.05)
    assert np.abs(np.corrcoef(wave.T)[~np.eye(5, dtype=bool)]).max() < 0.02


def test_hum_is_at_50_hz_and_common_to_all_probes(rk4: RigConfig) -> None:
    truth = replace(nameplate(rk4), noise=replace(Noise.none(), hum=2e-6))
    wave = volts(rk4, truth, *still(rk4, 10_000))[:, :4] / SENSITIVITY
    mains = phasor(wave, 2 * np.pi * 50 * np.arange(10_000) / RATE, 1)
    assert np.abs(mains) == pytest.approx(2e-6, rel=0.02)
    assert np.abs(mains - mains[0]).max() < 1e-8


def test_a_channel_without_a_probe_carries_a_little_noise_about_zero(jeffcott: RigConfig) -> None:
    truth = replace(nameplate(jeffcott), noise=Noise())
    wave = volts(jeffcott, truth, *still(jeffcott, 20_000))
    assert wave.shape == (20_000, 4)  # channels 0, 1 and 3 are in use
    assert abs(wave[:, 2].mean()) < 2e-5
    assert 2e-4 < wave[:, 2].std() < 1e-3


def test_a_gap_beyond_the_converter_is_clipped_at_its_last_count(rk4: RigConfig) -> None:
    motion, theta = still(rk4, 2)
    motion[0, 0, 0], motion[1, 0, 0] = 5e-3, -5e-3
    silent = nameplate(rk4)
    counts = Sensors(rk4, silent, make_chain(rk4, silent), sample_rate=RATE).counts(motion, theta)
    assert counts[:, 0].tolist() == [32767, -32768]
    assert counts.dtype == np.int32
