"""A rough track is there at every speed alike and reaches a plane's two probes one after the other."""

import numpy as np
import pytest
from scipy.integrate import quad

from rotorrig.rig.config.description import RigConfig

from ..by_hand import difference

TRACK = {"eccentricity": 8e-6, "angle": 0.9, "oval": 3e-6, "oval_angle": 0.2, "probe": 1.0}


def track(probe: int) -> np.ndarray:
    """Return the orders 1 and 2 of what that probe of the plane sees, by integrals over the profile's own angle."""

    def profile(theta: float) -> float:
        around = (theta + 0.9 + 2.0 + np.pi) % (2 * np.pi) - np.pi
        dent = 8e-6 / 2 * np.exp(-0.5 * (around / np.radians(8.0)) ** 2)
        return 8e-6 * np.cos(theta + 0.9) + 3e-6 * np.cos(2 * (theta + 0.2)) - dent

    turns = []
    for n, spots in ((1, 0.8e-6), (2, 0.3e-6)):
        middle = -2.9  # where the dent is: the integral is cut there
        parts = [
            quad(lambda a, n=n, f=f: profile(a) * f(n * a) / np.pi, middle - np.pi, middle + np.pi, points=[middle])[0]
            for f in (np.cos, np.sin)
        ]
        electrical = spots * np.exp(1j * n * (0.9 + 1.3 + 1.1 * probe))
        turns.append((complex(parts[0], -parts[1]) + electrical) * (-1j) ** (n * probe))
    return np.array(turns)


@pytest.mark.parametrize("rpm", [300, 1800])
def test_once_and_twice_per_turn_are_its_profile_and_each_probe_s_own_spots(rk4: RigConfig, rpm: float) -> None:
    first, second = (difference(rk4, "runout", TRACK, rpm=rpm, order=n) for n in (1, 2))
    want = np.array([track(0), track(1)])
    assert first[:2] == pytest.approx(want[:, 0], abs=0.15e-6)
    assert second[:2] == pytest.approx(want[:, 1], abs=0.15e-6)
    assert np.abs(first[2:]).max() < 0.05e-6  # the other plane is smooth
    assert abs(want[0, 0] - 8e-6 * np.exp(0.9j)) > 0.5e-6  # the two probes of a plane differ from a turned phasor
    assert abs(want[1, 0] / want[0, 0] + 1j) > 0.05
