"""Filled rubber: friction within the filler and a viscous part, each with its loss."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import hysteresis

from ..by_hand import driven

K = 33.9e3
REACH, CORNER = 5e-5, 37.0


def on_a_circle(rig: RigConfig, radius: float, hertz: float) -> complex:
    """Return what the law adds to the bearing's stiffness in x, of a whirl after some turns."""
    (rubber,) = hysteresis.forces(rig, nameplate(rig), {"loss_factor": 0.02, "frequency": CORNER})
    step, turns = 1 / hertz / 2000, 12
    t = step * np.arange(1, 2000 * turns + 1)
    z = radius * np.exp(2j * np.pi * hertz * t)
    # from the middle outwards in the first turn
    z *= np.minimum(t * hertz, 1.0)
    fx = driven(rubber, z.real, z.imag, step=step)[-2000:, 0]
    return complex(-2 * np.mean(fx * np.exp(-2j * np.pi * hertz * t[-2000:])) / radius)


@pytest.mark.parametrize(("radius", "hertz"), [(1e-5, 37.0), (5e-5, 37.0), (2e-4, 37.0), (5e-5, 10.0), (5e-5, 90.0)])
def test_on_a_circle_it_is_the_closed_form_of_both_parts(rk4: RigConfig, radius: float, hertz: float) -> None:
    """z = r / (1 - j q) of z' = v - |v| z / reach, and k j w T / (1 + j w T); each half stiff at the figures stated."""
    share = 0.02
    filler = 1 / (1 - 1j * radius / REACH)
    viscous = 1j * hertz / CORNER / (1 + 1j * hertz / CORNER)
    want = K * share * (filler + viscous - 1.0)
    assert on_a_circle(rk4, radius, hertz) == pytest.approx(want, rel=5e-3, abs=1e-3 * K * share)


def test_at_its_reach_and_frequency_loss_and_stiffness_are_those_stated(
    rk4: RigConfig,
) -> None:
    assert on_a_circle(rk4, REACH, CORNER) == pytest.approx(0.02j * K, abs=2e-3 * 0.02 * K + 1.0)
