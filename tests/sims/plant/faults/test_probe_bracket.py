"""A probe on a bracket that resonates."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import steady

BRACKET = {"share": 0.02, "frequency": 40.0, "damping_ratio": 0.04, "probe": 2.0}


@pytest.mark.parametrize("rpm", [1200, 2400, 3300])
def test_its_probe_reads_less_by_what_the_bracket_moves_and_the_others_are_right(rk4: RigConfig, rpm: float) -> None:
    """At 2400 rpm, 40 Hz, by 0.02 (1 + 0.08 j) / 0.08 j: a quarter of the motion, a quarter turn late."""
    healthy, off = (steady(rk4, "probe_bracket", BRACKET | {"share": s}, rpm=rpm) for s in (0.0, 0.02))
    r = rpm / 60 / 40.0
    moved = 0.02 * (1 + 0.08j * r) / (1 - r**2 + 0.08j * r)
    assert off[2] / healthy[2] == pytest.approx(1 - moved, abs=2e-3)
    assert np.delete(off, 2) == pytest.approx(np.delete(healthy, 2), abs=1e-9)
