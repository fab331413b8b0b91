"""A loose bearing: nothing within the gap, the balls beyond it."""

import numpy as np
import pytest
from scipy.optimize import minimize

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import clearance
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import felt, volts_of

KX, KY = 33.9e3, 34.6e3
GAP = 2e-5


def carried(rig: RigConfig, x: float, y: float, angle: float = 0.0) -> tuple[float, float]:
    """Return what is left of the linear bearing's pull on the shaft, with the sign of the displacement."""
    (slack,) = clearance.forces(rig, nameplate(rig), {"gap": GAP})
    fx, fy = felt(slack, x=x, y=y, angle=angle)
    return KX * x - fx, KY * y - fy


def test_under_a_ball_it_holds_nothing_within_the_gap_and_k_times_the_rest_beyond(rk4: RigConfig) -> None:
    for x, held in ((1.9e-5, 0.0), (2e-5, 0.0), (5e-5, 3e-5)):
        assert carried(rk4, x, 0.0) == pytest.approx((KX * held, 0.0), abs=1e-9)
        assert carried(rk4, 0.0, -x) == pytest.approx((0.0, -KY * held), abs=1e-9)


def test_between_two_balls_there_is_more_play(rk4: RigConfig) -> None:
    """A corner of an octagon is 1 / cos(22.5 deg) as far out as its sides; 30 mm of cage bring one to +x."""
    corner = GAP / np.cos(np.pi / 8)
    between = (np.pi / 8) / clearance.CAGE  # angle of the shaft that brings the cage half a ball on
    assert carried(rk4, 0.99 * corner, 0.0, between) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert carried(rk4, corner + 1e-5, 0.0, between) == pytest.approx((KX * 1e-5, 0.0), abs=1e-9)


def test_the_springs_relax_as_far_as_rigid_balls_let_them(rk4: RigConfig) -> None:
    """Against scipy's constrained minimum of the springs' energy over the eight half planes."""
    rng = np.random.default_rng(2)
    for _ in range(12):
        x, y = rng.uniform(-6e-5, 6e-5, 2)
        angle = rng.uniform(0, 20)
        balls = clearance.CAGE * angle + 2 * np.pi * np.arange(8) / 8
        n = np.stack([np.cos(balls), np.sin(balls)])
        best = minimize(
            lambda p, x=x, y=y: KX / KY * (x - p[0] * GAP) ** 2 / GAP**2 + (y - p[1] * GAP) ** 2 / GAP**2,
            np.zeros(2),
            constraints={"type": "ineq", "fun": lambda p, n=n: 1 - p @ n},
            options={"ftol": 1e-14},
        )
        px, py = best.x * GAP
        assert carried(rk4, x, y, angle) == pytest.approx((KX * (x - px), KY * (y - py)), abs=2e-4)


def test_at_rest_the_shaft_has_dropped_to_the_bottom_of_the_gap(rk4: RigConfig) -> None:
    """Its right end by the gap, or 8 % more between two balls, about a single left bearing at 65 mm: statics."""
    rk4 = rk4.model_copy(update={"bearings": (rk4.bearings[0], rk4.bearings[2])})
    heights = []
    for gap in (0.0, 4e-5):
        plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="clearance", parameters={"gap": gap})]))
        plant.advance(3.0)
        heights.append(volts_of(plant, 1.0)[:, [1, 3]].mean(axis=0) / 7874.0)
    drop = (heights[1] - heights[0]) / np.array([-4e-5 * 185.5 / 416, -4e-5 * 315.5 / 416])
    assert drop[0] == pytest.approx(drop[1], rel=0.01)
    assert 0.99 < drop[0] < 1.01 / np.cos(np.pi / 8)
    assert np.all(heights[0] < 0)
