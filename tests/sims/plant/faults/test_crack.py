"""A crack opens on the stretched side, gradually."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import crack

from ..by_hand import felt, settled

CRACK = {"compliance": 1e-4, "position": 0.15}


def sag(rig: RigConfig, angle: float) -> float:
    """Return how far down the disk hangs with the crack's mouth at `angle` from +x."""
    return -settled(rig.model_copy(update={"gravity": "-y"}), "crack", CRACK | {"angle": angle})[1]


def test_below_it_gives_as_a_hinge_and_above_not_at_all(jeffcott: RigConfig) -> None:
    """The hinge turns by M c under M = W z / 2 and lowers midspan by z / 2 of that: W c (z / 2)^2."""
    whole = 9.80665 / 73.631e3
    assert sag(jeffcott, -np.pi / 2) - whole == pytest.approx(9.80665 * 1e-4 * 0.075**2, rel=0.02)
    assert sag(jeffcott, np.pi / 2) == pytest.approx(whole, rel=1e-4)


def test_turning_under_a_steady_bend_it_gives_once_per_turn_with_harmonics(rk4: RigConfig) -> None:
    """(1 + c) / 2 (0.2 + 0.8 c^2), by c = (e + 1/e) / 2: 0.3 of it on the average, 0.4, 0.2 and 0.1 at 1X, 2X, 3X."""
    (force,) = crack.forces(rk4, nameplate(rk4), crack.PARAMETERS | {"angle": 0.0})
    lost = force.constants[0]
    upright = [felt(force, y=1e-3, angle=a)[1] for a in 2 * np.pi * np.arange(64) / 64 - np.pi / 2]
    orders = np.fft.rfft(upright)[:5] / 64 / (lost * 1e-3)  # slopes that rise bulge it downwards
    assert orders[0].real == pytest.approx(0.3)
    assert 2 * np.abs(orders[1:]) == pytest.approx([0.4, 0.2, 0.1, 0.0], abs=1e-12)


def test_its_moments_are_the_slope_of_the_energy_it_lacks(rk4: RigConfig) -> None:
    """E = lost / 2 b^2 (1 + cos a) / 2 (cos^2 a + 0.2 sin^2 a), a from mouth to bulge: by differences of that."""
    (force,) = crack.forces(rk4, nameplate(rk4), crack.PARAMETERS | {"angle": 0.3})
    lost, mouth = force.constants

    def energy(x: float, y: float) -> float:
        a = np.arctan2(-y, -x) - (mouth + 1.1)
        return lost / 2 * (x * x + y * y) * (1 + np.cos(a)) / 2 * (np.cos(a) ** 2 + 0.2 * np.sin(a) ** 2)

    for x, y in ((1e-3, 2e-3), (-2e-3, 5e-4), (-1e-3, -1e-3), (3e-3, -4e-3)):
        h = 1e-8
        slopes = [(energy(x + h * dx, y + h * dy) - energy(x - h * dx, y - h * dy)) / (2 * h) for dx, dy in np.eye(2)]
        assert felt(force, x=x, y=y, angle=1.1) == pytest.approx(slopes, abs=1e-6 * lost * 1e-3)
