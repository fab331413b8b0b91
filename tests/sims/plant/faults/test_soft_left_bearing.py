"""A soft seat under the bearings nobody looks at."""

import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_deviations
from rotorrig.sims.plant.truth import FaultSpec


def test_compliances_add_up_under_the_left_pair_and_the_spring_bearing_keeps_its_own(rk4: RigConfig) -> None:
    """Rubber of 1 um/N that loses 0.15: at 230 rad/s the two compliances, complex, are those of both in a row."""
    plain = nameplate(rk4).bearings
    faults = [FaultSpec(name="soft_left_bearing", parameters={"compliance": 1e-6})]
    left_a, left_b, spring = apply_deviations(rk4, nameplate(rk4, faults=faults)).bearings
    for bearing, was in ((left_a, plain[0]), (left_b, plain[1])):
        across = 1 / (bearing.kxx + 230j * bearing.cxx)
        upright = 1 / (bearing.kyy + 230j * bearing.cyy)
        assert across == pytest.approx(1 / (was.kxx + 230j * was.cxx) + 1e-6 / (1 + 0.15j))
        assert upright == pytest.approx(1 / (was.kyy + 230j * was.cyy) + 0.8e-6 / (1 + 0.15j))
    assert left_a.cxx > plain[0].cxx  # rubber damps
    assert (spring.kxx, spring.kyy) == (33.9e3, 34.6e3)
