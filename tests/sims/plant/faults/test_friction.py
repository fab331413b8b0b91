"""Dry friction takes the same off every swing, and then holds."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import friction

from ..by_hand import felt, ring_down


def test_swings_lose_four_times_the_limit_over_the_stiffness_each(jeffcott: RigConfig) -> None:
    """Energy 4 F A per cycle out of k A^2 / 2 (Den Hartog, Mechanical Vibrations); F / k = 1.36 um."""
    values = {"limit": 0.1, "stuck_stiffness": 2e6}
    x = ring_down(jeffcott, "friction", values, amplitude=1e-4, seconds=0.8)
    peaks = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]) & (x[1:-1] > 2e-5)]
    material = 1 - np.exp(-3e-6 * 73.631e3 / 2 * 2 * np.pi / np.sqrt(73.631e3))  # of the amplitude, per cycle
    lost = -np.diff(peaks) - material * peaks[:-1]
    assert lost.mean() == pytest.approx(4 * 0.1 / 73.631e3, rel=0.03)
    assert lost.std() < 0.05 * lost.mean()  # the same from every swing, unlike a viscous damper
    assert np.ptp(x[-300:]) < 3e-6  # less than the band within which it sticks


def test_it_follows_like_a_spring_until_it_slides(rk4: RigConfig) -> None:
    (slider,) = friction.forces(rk4, nameplate(rk4), {"limit": 0.05, "stuck_stiffness": 1e5})
    assert felt(slider, x=3e-7) == pytest.approx((-0.03, 0.0))
    assert felt(slider, x=3e-6, y=4e-6) == pytest.approx((-0.03, -0.04))
