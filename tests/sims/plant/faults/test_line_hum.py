"""Mains in the cables: there at standstill, the same in every probe."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import volts_of


def test_it_is_a_tone_and_its_third_at_standstill(rk4: RigConfig) -> None:
    values = {"amount": 2e-6, "frequency": 60.0, "third": 0.5, "phase": 0.3}
    plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="line_hum", parameters=values)]))
    wave = volts_of(plant, 2.0)[:, :4] / 7874.0
    t = np.arange(20_000) / 1e4
    for hertz, expected in ((60, 2e-6), (180, 1e-6), (120, 0.0)):
        tone = 2 * np.mean((wave - wave.mean(axis=0)) * np.exp(-2j * np.pi * hertz * t)[:, None], axis=0)
        assert np.abs(tone) == pytest.approx([expected] * 4, abs=0.03e-6)
        assert np.abs(tone - tone[0]).max() < 0.03e-6
