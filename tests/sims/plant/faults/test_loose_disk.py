"""A disk that falls behind its shaft."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import measured, run_to


def test_the_heavy_spot_wanders_by_the_share_of_a_turn_that_rolling_loses(rk4: RigConfig) -> None:
    """c / (R + c) of 360 degrees per turn, R = 5 mm: 1.4 degrees at 20 um; far below critical."""
    plant = run_to(
        Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="loose_disk", parameters={"clearance": 2e-5})])), 600
    )
    phases = np.unwrap([np.angle(measured(plant, 1.0)[0]) for _ in range(4)])
    per_turn = np.diff(phases).mean() / 10
    assert per_turn == pytest.approx(-math.tau * 2e-5 / 5.02e-3, rel=0.03)
