"""A lossy bearing: the same loss per cycle at every frequency."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import hysteresis
from rotorrig.sims.plant.force_laws import Motion, Turn


def complex_stiffness(rig: RigConfig, hertz: float) -> complex:
    """Return what the law adds to the bearing's stiffness in x, from a sine of 1 um after ten cycles and 3 s."""
    (chain,) = hysteresis.forces(rig, nameplate(rig), {"loss_factor": 0.02, "frequency": 37.0})
    h = 1e-4
    memory, after = np.zeros(chain.memory), np.zeros(chain.memory)
    cycles = math.ceil(max(10, 3 * hertz))
    t = h * np.arange(1, round((cycles + 1) / hertz / h) + 1)
    x, force = 1e-6 * np.sin(2 * np.pi * hertz * t), []
    constants = np.array(chain.constants)
    for now, at in zip(t, x, strict=True):
        turn, motion = Turn(now, 0.0, 0.0, 0.0, h), Motion(at, 0.0, 0.0, 0.0)
        force.append(chain.law(turn, motion, constants, memory, after)[0])
        memory, after = after, memory
    last = t > t[-1] - 1 / hertz
    turning = np.exp(-2j * np.pi * hertz * t[last])
    return -np.mean(np.array(force)[last] * turning) / np.mean(x[last] * turning)


@pytest.mark.parametrize("hertz", [4.0, 20.0, 60.0, 120.0])
def test_the_loss_factor_is_the_same_at_every_frequency(rk4: RigConfig, hertz: float) -> None:
    assert complex_stiffness(rk4, hertz).imag == pytest.approx(0.02 * 33.9e3, rel=0.1)


def test_the_stiffness_is_the_nameplate_s_at_its_frequency_and_less_below(rk4: RigConfig) -> None:
    """It rises by 2 / pi of the loss factor per factor e of frequency: no causal law can do with less."""
    assert complex_stiffness(rk4, 37.0).real == pytest.approx(0.0, abs=0.002 * 33.9e3)
    slope = complex_stiffness(rk4, 37.0).real - complex_stiffness(rk4, 37.0 / math.e).real
    assert slope == pytest.approx(0.02 * 2 / np.pi * 33.9e3, rel=0.1)
