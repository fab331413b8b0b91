"""Late channels turn every order by its own share."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import steady


def test_the_phase_falls_behind_by_time_times_speed_and_the_amplitude_stays(rk4: RigConfig) -> None:
    for rpm in (900, 2000):
        plain, late = (steady(rk4, "delay", {"time": t}, rpm=rpm) for t in (0.0, 3.3e-4))
        assert late / plain == pytest.approx(np.exp(-1j * rpm * np.pi / 30 * 3.3e-4), abs=2e-3)


def test_twice_per_turn_is_turned_twice_as_far(rk4: RigConfig) -> None:
    faults = {"bore_force": 0.0, "stiffness_variation": 9000.0}
    plain, late = (
        steady(rk4, "coupling", faults, also=t, rpm=1100, order=2) for t in (None, ("delay", {"time": 3e-4}))
    )
    assert np.angle(late / plain) == pytest.approx(-2 * 1100 * np.pi / 30 * 3e-4, abs=0.01)
