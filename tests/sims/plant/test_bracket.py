"""A probe's bracket against its transfer function and against scipy's integration."""

import numpy as np
import pytest
from scipy.signal import TransferFunction, lsim

from rotorrig.sims.plant.sensors.bracket import Brackets

RATE = 10_000.0
HERTZ, RATIO = 45.0, 0.03


def test_under_a_sine_it_moves_as_a_mass_on_a_moving_base() -> None:
    """In step with the base far below, by 1 / (2 zeta) at its own frequency, hardly above: Thomson's fig. 3.5-2."""
    t = np.arange(30_000) / RATE
    for hertz in (5.0, 45.0, 300.0):
        base = np.sin(2 * np.pi * hertz * t)[:, None]
        moved = Brackets(np.array([[0.02, HERTZ, RATIO]]), sample_rate=RATE).move(base)[20_000:]
        got = 2j * np.mean(moved[:, 0] * np.exp(-2j * np.pi * hertz * t[20_000:]))
        r = hertz / HERTZ
        assert got == pytest.approx(0.02 * (1 + 2j * RATIO * r) / (1 - r**2 + 2j * RATIO * r), rel=5e-3)


def test_any_motion_is_followed_as_by_scipy_s_simulation() -> None:
    wave = np.cumsum(np.random.default_rng(4).standard_normal(4000))
    wave -= wave[0]
    w = 2 * np.pi * HERTZ
    _, want, _ = lsim(TransferFunction([2 * RATIO * w, w * w], [1, 2 * RATIO * w, w * w]), wave, np.arange(4000) / RATE)
    got = Brackets(np.array([[1.0, HERTZ, RATIO]]), sample_rate=RATE).move(wave[:, None])[:, 0]
    assert got == pytest.approx(want, abs=1e-6 * np.abs(want).max())


def test_it_stands_still_at_first_and_blocks_are_as_one() -> None:
    wave = 1e-4 + 1e-5 * np.random.default_rng(1).standard_normal((500, 2))
    brackets = np.array([[0.0, HERTZ, RATIO], [0.03, HERTZ, RATIO]])
    whole = Brackets(brackets, sample_rate=RATE).move(wave)
    parts = Brackets(brackets, sample_rate=RATE)
    pieces = [parts.move(wave[a:b]) for a, b in ((0, 0), (0, 1), (1, 60), (60, 500))]
    assert np.array_equal(np.concatenate(pieces), whole)
    assert np.all(whole[:, 0] == 0.0)
    assert whole[0, 1] == 0.0
    assert np.abs(whole[:, 1]).max() > 1e-8
