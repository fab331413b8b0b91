"""A pedestal that opens once per turn."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import loose_pedestal

from ..by_hand import felt, steady

LOOSE = {"loss": 0.4, "lift": 1e-5}


def test_it_gives_upwards_beyond_its_lift_and_not_downwards(rk4: RigConfig) -> None:
    (opening,) = loose_pedestal.forces(rk4, nameplate(rk4), LOOSE)
    assert felt(opening, y=-1e-4) == (0.0, 0.0)
    assert felt(opening, x=1e-4, y=1e-5) == (0.0, 0.0)
    assert felt(opening, y=6e-5) == pytest.approx((0.0, 0.4 * 34.6e3 * 5e-5))


def test_opening_once_per_turn_it_makes_a_second_harmonic_upright(rk4: RigConfig) -> None:
    loose, tight = (np.abs(steady(rk4, "loose_pedestal", LOOSE | {"loss": q}, rpm=1900, order=2)) for q in (0.4, 0.0))
    assert loose[1] > 1e-6 > 10 * tight[1]
    assert loose[0] < 0.1 * loose[1]
