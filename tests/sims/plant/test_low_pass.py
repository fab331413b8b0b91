"""The anti-alias filter against its transfer function and against scipy's integration."""

import numpy as np
import pytest
from scipy.signal import TransferFunction, lsim

from rotorrig.sims.plant.sensors.low_pass import LowPass

RATE = 10_000.0


def test_a_sine_comes_out_as_the_transfer_function_says() -> None:
    t = np.arange(20_000) / RATE
    delay = np.array([2e-5, 1.5e-4, 4e-4])
    for hertz in (30.0, 300.0):
        wave = np.repeat(np.sin(2 * np.pi * hertz * t)[:, None], 3, axis=1)
        out = LowPass(delay, sample_rate=RATE).filter(wave)[10_000:]
        got = 2 * np.mean(out * np.exp(-2j * np.pi * hertz * t[10_000:, None]), axis=0) * 1j
        corner = np.sqrt(2) / delay
        s = 2j * np.pi * hertz / corner
        # straight lines between samples take (w h)^2 / 12 off a sine: 0.3 % at 300 Hz
        assert got == pytest.approx(1 / (s * s + np.sqrt(2) * s + 1), rel=5e-3)


def test_any_signal_comes_out_as_scipy_s_simulation_of_the_filter() -> None:
    rng = np.random.default_rng(4)
    wave = np.cumsum(rng.standard_normal(400))
    wave -= wave[0]
    w = np.sqrt(2) / 3e-4
    _, want, _ = lsim(TransferFunction([w * w], [1, np.sqrt(2) * w, w * w]), wave, np.arange(400) / RATE)
    got = LowPass(np.array([3e-4]), sample_rate=RATE).filter(wave[:, None])[:, 0]
    assert got == pytest.approx(want, abs=1e-6 * np.abs(want).max())


def test_blocks_are_as_one_and_no_delay_is_no_filter() -> None:
    wave = np.random.default_rng(1).standard_normal((500, 2))
    whole = LowPass(np.array([0.0, 2e-4]), sample_rate=RATE).filter(wave)
    parts = LowPass(np.array([0.0, 2e-4]), sample_rate=RATE)
    pieces = [parts.filter(wave[a:b]) for a, b in ((0, 0), (0, 1), (1, 60), (60, 500))]
    assert np.array_equal(np.concatenate(pieces), whole)
    assert np.array_equal(whole[:, 0], wave[:, 0])
    assert whole[0, 1] == wave[0, 1]  # it had stood there
