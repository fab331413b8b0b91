"""A hardening spring rings higher the further it swings."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import ring_down, upward_crossings


def test_the_frequency_follows_duffing_s_backbone(jeffcott: RigConfig) -> None:
    """w^2 = k/m + 3/4 k3 A^2 / m to first order (Nayfeh and Mook (1979), sec. 4.1); here 1 %."""
    amplitude, k3 = 1e-4, 2e11
    x = ring_down(jeffcott, "cubic_spring", {"k3": k3}, amplitude=amplitude, seconds=0.5)
    crossing = upward_crossings(x)
    w = 2 * np.pi * (len(crossing) - 1) / (crossing[-1] - crossing[0])
    mean_square = np.mean(x**2) * 2  # the material's damping takes some per cent within the window
    assert w == pytest.approx(np.sqrt(73.631e3 + 0.75 * k3 * mean_square), rel=5e-4)
    assert w / np.sqrt(73.631e3) > 1.008
