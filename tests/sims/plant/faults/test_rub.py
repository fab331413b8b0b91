"""A ring round the shaft."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import rub

from ..by_hand import felt, steady

RING = {"stiffness": 1e4, "gap": 1e-4, "friction": 0.1, "position": 0.32}


def test_it_pushes_back_beyond_the_gap_and_drags_against_the_rotation(rk4: RigConfig) -> None:
    (ring,) = rub.forces(rk4, nameplate(rk4), RING)
    assert felt(ring, x=0.9e-4) == (0.0, 0.0)
    # 0.5 m/s of slip at 100 rad/s on a radius of 5 mm: full friction, along -y at the +x side of a shaft from x to y
    assert felt(ring, x=3e-4, omega=100.0) == pytest.approx((-2.0, -0.2), rel=1e-6)
    assert felt(ring, y=3e-4, omega=100.0) == pytest.approx((0.2, -2.0), rel=1e-6)
    assert felt(ring, y=3e-4, omega=-100.0) == pytest.approx((-0.2, -2.0), rel=1e-6)


def test_a_whirl_that_would_pass_the_gap_is_held_near_it(rk4: RigConfig) -> None:
    free, held = (abs(steady(rk4, "rub", RING | {"stiffness": k}, rpm=2150)[0]) for k in (0.0, 5e4))
    assert free > 1.2e-4
    assert held < 1.1e-4
    assert np.isfinite(held)
