"""A soft ring that the shaft touches beyond a gap."""

import numpy as np
import pytest
from scipy.optimize import brentq

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import snubber

from ..by_hand import felt, steady

RING = {"stiffness": 2e4, "gap": 1e-4, "offset": 0.0, "angle": 0.0, "position": 0.2}


def test_it_pushes_back_square_to_its_surface_and_nothing_within_the_gap(rk4: RigConfig) -> None:
    """Off by 60 um along y: 40 um of play left upwards is 160 um downwards, and 80 um sideways."""
    (ring,) = snubber.forces(rk4, nameplate(rk4), RING | {"offset": 0.6, "angle": -np.pi / 2})
    for x, y in ((0.0, 0.39e-4), (0.0, -1.59e-4), (0.79e-4, 0.0)):
        assert felt(ring, x=x, y=y, omega=500.0) == (0.0, 0.0)
    assert felt(ring, y=0.9e-4) == pytest.approx((0.0, -2e4 * 5e-5))
    assert felt(ring, y=-2.1e-4) == pytest.approx((0.0, 2e4 * 5e-5))
    # 120 um along x and 90 um along y of its centre: 150 um, of which 50 um push, against (0.8, 0.6)
    assert felt(ring, x=1.2e-4, y=0.3e-4) == pytest.approx((-0.8, -0.6))


@pytest.mark.parametrize("share", [0.9, 1.02])
def test_a_centred_one_bends_the_resonance_of_a_jeffcott_rotor(jeffcott: RigConfig, share: float) -> None:
    """A circle of radius R with |k + k_s (1 - gap / R) - m W^2 + j c W| R = U W^2; beyond critical it grows."""
    w = np.sqrt(73.631e3) * share
    pushed = RING | {"gap": 4e-5}

    def off(r: float) -> float:
        k = 73.631e3 + 2e4 * max(1 - 4e-5 / r, 0.0) - w**2
        return float(np.hypot(k, 27.13 * w) * r - 20e-6 * w**2)

    got = np.abs(steady(jeffcott, "snubber", pushed, rpm=w * 30 / np.pi))
    assert got[0] == pytest.approx(brentq(off, 1e-6, 1e-3), rel=0.01)
    assert got[1] == pytest.approx(got[0], rel=1e-3)
    free = np.abs(steady(jeffcott, None, {}, rpm=w * 30 / np.pi))
    assert got[0] < 0.95 * free[0]


def test_touched_on_one_side_it_pushes_once_per_turn_and_makes_a_second_harmonic(jeffcott: RigConfig) -> None:
    """Most of all at half the critical speed."""
    aside = RING | {"gap": 1e-5, "offset": 0.6}  # 4 um of play to one side, 16 um to the other; a whirl of 6.7 um
    second = [np.abs(steady(jeffcott, "snubber", v, rpm=1295, order=2)) for v in (aside, aside | {"offset": 0.0})]
    assert second[0].max() > 1e-6 > 20 * second[1].max()
