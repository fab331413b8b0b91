"""A spring that is too stiff, askew in its bearing."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_deviations
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.plant.truth import FaultSpec


def test_a_round_rotor_becomes_critical_twice_along_the_diagonals(jeffcott: RigConfig) -> None:
    """A spring of d along x = y and 0.4 d across: kxy = 0.3 d = 4 kN/m; the disk's spring is the shaft's 73.63 kN/m."""
    faults = [FaultSpec(name="cross_stiffness", parameters={"stiffness": 4000.0})]
    truth = apply_deviations(jeffcott, nameplate(jeffcott, faults=faults))
    d = 4000.0 / 0.3
    expected = np.sqrt([73.631e3 + 0.4 * d, 73.631e3 + d])
    assert build(jeffcott, truth).critical_speeds(2) == pytest.approx(expected, rel=2e-4)


def test_only_the_bearings_sought_have_it_and_it_is_symmetric(rk4: RigConfig) -> None:
    truth = apply_deviations(
        rk4, nameplate(rk4, faults=[FaultSpec(name="cross_stiffness", parameters={"stiffness": -900.0})])
    )
    assert [(b.kxy, b.kyx) for b in truth.bearings] == [(0.0, 0.0), (0.0, 0.0), (-900.0, -900.0)]
    assert [b.kxx for b in truth.bearings] == pytest.approx([2e6, 2e6, 33.9e3 + 2100.0])
    assert truth.bearings[2].kyy == pytest.approx(34.6e3 + 2100.0)
