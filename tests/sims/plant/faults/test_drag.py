"""Square-law drag bites at large swings and lets small ones go."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import ring_down


def test_one_over_the_amplitude_grows_evenly(jeffcott: RigConfig) -> None:
    """8/3 c w^2 A^3 of energy per cycle: d(1/A)/dt = 4 c w / (3 pi m)."""
    x = ring_down(jeffcott, "drag", {"coefficient": 100.0}, amplitude=1e-4, seconds=1.0)
    peaks = 1 + np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]))
    t, inverse = peaks * 1e-4, 1 / x[peaks]
    material = 3e-6 * 73.631e3 / 2  # 1/s; it makes 1/A grow by itself, taken off by averages over short stretches
    rate = np.diff(inverse) / np.diff(t) - material * (inverse[1:] + inverse[:-1]) / 2
    expected = 4 * 100.0 * np.sqrt(73.631e3) / (3 * np.pi)
    assert rate.mean() == pytest.approx(expected, rel=0.03)
