"""A bow seen at slow roll, and what a mass on a bent spring makes of it."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import difference

BOW = {"amount": 20e-6, "angle": 0.5}


def test_at_slow_roll_the_disk_stands_off_by_the_bow_in_its_direction(jeffcott: RigConfig) -> None:
    z = difference(jeffcott, "bow", BOW, rpm=120)
    assert z[0] == pytest.approx(20e-6 * np.exp(0.5j), rel=0.01)
    assert z[1] == pytest.approx(-1j * z[0], rel=0.01)  # forward, so y a quarter turn later


def test_it_is_amplified_as_a_constant_force_is(jeffcott: RigConfig) -> None:
    """k b = (k - m W^2 + j c W) z: Friswell et al. (2010), sec. on bent rotors; at 0.6 w and beyond it."""
    w = np.sqrt(73.631e3)
    for ratio in (0.6, 1.5):
        z = difference(jeffcott, "bow", BOW, rpm=ratio * w * 30 / np.pi)
        assert z[0] == pytest.approx(20e-6 * np.exp(0.5j) / (1 - ratio**2 + 0.1j * ratio), rel=0.01)
