"""A bearing on short wires: it rings higher the further it swings."""

import numpy as np
import pytest
from scipy.integrate import quad

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import cubic_spring

from ..by_hand import felt, ring_down, upward_crossings

K3, HALF = 2e11, 1e-3
EA = K3 * HALF**3


def test_the_force_is_two_wires_pull_by_pythagoras(rk4: RigConfig) -> None:
    (wires,) = cubic_spring.forces(rk4, nameplate(rk4), {"k3": K3, "half_length": HALF})
    for r in (1e-6, 1e-4, 8e-4):
        long = np.hypot(HALF, r)
        pull = EA * (long - HALF) / HALF
        assert np.hypot(*felt(wires, x=0.6 * r, y=-0.8 * r)) == pytest.approx(2 * pull * r / long, rel=1e-6)
        fx, fy = felt(wires, x=0.6 * r, y=-0.8 * r)
        assert (fx < 0) and fy == pytest.approx(-fx * 0.8 / 0.6)


def test_the_frequency_is_that_of_a_quarter_swing_by_energy(jeffcott: RigConfig) -> None:
    """T = 4 int dx / sqrt(2 (E(A) - E(x)) / m), E of the shaft's spring and the wires' stretch."""
    amplitude = 3e-4
    x = ring_down(jeffcott, "cubic_spring", {"k3": K3, "half_length": HALF}, amplitude=amplitude, seconds=0.06)
    crossing = upward_crossings(x)[:2]
    swing = np.abs(x[(crossing[0] * 1e4).astype(int) : (crossing[1] * 1e4).astype(int)]).max()

    def energy(r: float) -> float:
        return 73.631e3 * r * r / 2 + EA / HALF * (np.hypot(HALF, r) - HALF) ** 2

    def slowness(angle: float) -> float:
        r = swing * np.sin(angle)
        return swing * np.cos(angle) / np.sqrt(2 * (energy(swing) - energy(r)))

    period = 4 * quad(slowness, 0, np.pi / 2 - 1e-6)[0]
    assert crossing[1] - crossing[0] == pytest.approx(period, rel=3e-3)
    assert period < 0.95 * 2 * np.pi / np.sqrt(73.631e3)
