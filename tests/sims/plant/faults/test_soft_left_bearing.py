"""A soft seat under the bearings nobody looks at."""

import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_deviations
from rotorrig.sims.plant.truth import FaultSpec


def test_compliances_add_up_under_the_left_pair_and_the_spring_bearing_keeps_its_own(rk4: RigConfig) -> None:
    faults = [FaultSpec(name="soft_left_bearing", parameters={"compliance": 1e-6})]
    left_a, left_b, spring = apply_deviations(rk4, nameplate(rk4, faults=faults)).bearings
    for bearing in (left_a, left_b):
        assert 1 / bearing.kxx == pytest.approx(1 / 2e6 + 1e-6)
        assert 1 / bearing.kyy == pytest.approx(1 / 2e6 + 1e-6)
    assert (spring.kxx, spring.kyy) == (33.9e3, 34.6e3)
