"""Late channels turn every order by its own share."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import steady

CORNER = math.sqrt(2) / 3.3e-4  # rad/s


def butterworth(omega: float) -> complex:
    """Return the filter's response, by its poles at the corner, 45 degrees off the axis."""
    poles = CORNER * np.exp(1j * np.pi * np.array([0.75, 1.25]))
    return complex(CORNER**2 / np.prod(1j * omega - poles))


def test_the_phase_falls_behind_as_a_butterworth_filter_s(rk4: RigConfig) -> None:
    for rpm in (900, 2000):
        plain, late = (steady(rk4, "delay", {"time": t}, rpm=rpm) for t in (0.0, 3.3e-4))
        assert late / plain == pytest.approx(butterworth(rpm * np.pi / 30), abs=2e-3)
        assert butterworth(rpm * np.pi / 30) == pytest.approx(np.exp(-1j * rpm * np.pi / 30 * 3.3e-4), abs=2e-3)


def test_twice_per_turn_is_turned_twice_as_far(rk4: RigConfig) -> None:
    faults = {"bore_force": 0.0, "stiffness_variation": 9000.0}
    plain, late = (
        steady(rk4, "coupling", faults, also=t, rpm=1100, order=2) for t in (None, ("delay", {"time": 3.3e-4}))
    )
    assert late / plain == pytest.approx(butterworth(2 * 1100 * np.pi / 30), abs=0.01)
