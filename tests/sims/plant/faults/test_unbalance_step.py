"""A screw that moves once."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.description import RigConfig
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec, UnbalanceTruth, nameplate

from ..by_hand import RPM, measured, run_to

STEP = {"amount": 6e-6, "angle": 2.0, "speed": 1200 * RPM}


def test_it_happens_at_its_speed_and_stays_when_the_speed_has_gone(rk4: RigConfig) -> None:
    """Afterwards the rig is one with the two unbalances' sum on its nameplate."""
    plain = nameplate(rk4)
    total = 15e-6 + 6e-6 * np.exp(2j)
    after = UnbalanceTruth(disk="disk", amount=abs(total), angle=float(np.angle(total)))
    plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="unbalance_step", parameters=STEP)]))
    healthy, other = Plant(rk4, plain), Plant(rk4, replace(plain, unbalances=(after,)))
    for rpm, twin in ((1000, healthy), (1400, other), (1000, other)):
        got, want = (measured(run_to(p, rpm), 1.0) for p in (plant, twin))
        assert got == pytest.approx(want, abs=0.05e-6)


def test_before_its_time_nothing_happens(rk4: RigConfig) -> None:
    late = FaultSpec(name="unbalance_step", parameters=STEP | {"speed": 0.0, "time": 6.0})
    plant, healthy = Plant(rk4, nameplate(rk4, faults=[late])), Plant(rk4, nameplate(rk4))
    for p in (plant, healthy):
        p.command(1200 * RPM, 200.0, True)
    assert np.abs(plant.advance(5.9) - healthy.advance(5.9)).max() == 0
    plant.advance(9.0), healthy.advance(9.0)
    assert abs(measured(plant, 1.0)[0] - measured(healthy, 1.0)[0]) > 1e-6
