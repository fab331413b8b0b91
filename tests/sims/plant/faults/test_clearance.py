"""A loose bearing: nothing within the gap, the bearing beyond it."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import clearance
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import felt, volts_of


def test_with_the_linear_bearing_it_holds_nothing_within_the_gap_and_k_times_the_rest_beyond(rk4: RigConfig) -> None:
    (slack,) = clearance.forces(rk4, nameplate(rk4), {"gap": 2e-5})
    for x, held in ((1.9e-5, 0.0), (2e-5, 0.0), (5e-5, 3e-5)):
        fx, _ = felt(slack, x=x)
        assert 33.9e3 * x - fx == pytest.approx(33.9e3 * held, abs=1e-9)
        _, fy = felt(slack, y=-x)
        assert 34.6e3 * -x - fy == pytest.approx(-34.6e3 * held, abs=1e-9)


def test_at_rest_the_shaft_has_dropped_to_the_bottom_of_the_gap(rk4: RigConfig) -> None:
    """Its right end by the gap, about a single left bearing at 65 mm: nothing but statics."""
    rk4 = rk4.model_copy(update={"bearings": (rk4.bearings[0], rk4.bearings[2])})
    heights = []
    for gap in (0.0, 4e-5):
        plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="clearance", parameters={"gap": gap})]))
        plant.advance(3.0)
        heights.append(volts_of(plant, 1.0)[:, [1, 3]].mean(axis=0) / 7874.0)
    assert heights[1] - heights[0] == pytest.approx([-4e-5 * 185.5 / 416, -4e-5 * 315.5 / 416], rel=0.02)
    assert np.all(heights[0] < 0)
