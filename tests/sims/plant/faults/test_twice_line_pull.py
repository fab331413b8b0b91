"""A pull on the disk at twice the line frequency."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import difference, free_motion, run_to, volts_of

COIL = {"pull": 2.0, "angle": 0.4, "phase": 0.9, "frequency": 50.0, "disk": 0.0}


@pytest.mark.parametrize("hertz", [50.0, 20.0])
def test_a_standing_disk_is_drawn_aside_and_swings_twice_as_fast_as_the_line(jeffcott: RigConfig, hertz: float) -> None:
    """About F / k, and by F / (k - m w^2 + j c w) at w = 4 pi times the line's frequency."""
    motion = free_motion(jeffcott, "twice_line_pull", COIL | {"frequency": hertz}, gravity=(0.0, 0.0))
    still = np.zeros(30_000)
    seen = motion.run(still, still, still)[20_000:, 0]
    t = 1e-4 * (20_001 + np.arange(10_000))
    w = 4 * np.pi * hertz
    c = 27.13 + 3e-6 * 73.631e3
    swing = 2 * np.mean(seen * np.exp(-1j * w * t)[:, None], axis=0)
    want = 2.0 * np.exp(0.9j) / (73.631e3 - w**2 + 1j * c * w)
    assert swing == pytest.approx(want * np.array([np.cos(0.4), np.sin(0.4)]), rel=5e-3)
    assert seen.mean(axis=0) == pytest.approx(2.0 / 73.631e3 * np.array([np.cos(0.4), np.sin(0.4)]), rel=1e-3)


def test_it_is_a_line_of_the_spectrum_and_no_order_of_the_shaft(rk4: RigConfig) -> None:
    """At 1800 rpm 100 Hz is 3.33 X: of 29 turns 1 / (29 * 0.33 pi) of it at most is taken for 3X."""
    spec = FaultSpec(name="twice_line_pull", parameters=COIL)
    wave = volts_of(run_to(Plant(rk4, nameplate(rk4, faults=[spec])), 1800), 1.0)[:, :4] / 7874.0
    line = 2 * np.abs(np.mean(wave * np.exp(-2j * np.pi * 100 * np.arange(10_000) / 1e4)[:, None], axis=0))
    assert line.min() > 1e-6
    for order in (1, 2, 3):
        assert np.all(np.abs(difference(rk4, "twice_line_pull", COIL, rpm=1800, order=order)) < 0.05 * line)
