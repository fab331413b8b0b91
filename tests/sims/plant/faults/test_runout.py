"""A rough track is there at every speed alike and reaches a plane's two probes one after the other."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import difference

TRACK = {"eccentricity": 8e-6, "angle": 0.9, "oval": 3e-6, "oval_angle": 0.2, "probe": 1.0}


@pytest.mark.parametrize("rpm", [300, 1800])
def test_once_and_twice_per_turn_are_its_eccentricity_and_oval(rk4: RigConfig, rpm: float) -> None:
    first, second = (difference(rk4, "runout", TRACK, rpm=rpm, order=n) for n in (1, 2))
    assert first[:2] == pytest.approx(8e-6 * np.exp(0.9j) * np.array([1, -1j]), rel=0.02)
    assert second[:2] == pytest.approx(3e-6 * np.exp(0.4j) * np.array([1, -1]), rel=0.02)
    assert np.abs(first[2:]).max() < 0.05e-6  # the other plane is smooth
