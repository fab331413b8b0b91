"""Mains in the cables: there at standstill, the same in every probe."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import volts_of


def test_it_is_a_tone_and_its_third_at_standstill_unlike_in_every_probe(rk4: RigConfig) -> None:
    """From 0.75 to 1.25 of it and from -0.25 to 0.25 rad along the cables; it strays by 0.04 % within a minute."""
    values = {"amount": 2e-6, "frequency": 60.0, "third": 0.5, "phase": 0.3}
    plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="line_hum", parameters=values)]))
    wave = volts_of(plant, 2.0)[:, :4] / 7874.0
    t = np.arange(1, 20_001) / 1e4
    longer = np.array([-1, -1 / 3, 1 / 3, 1]) / 4
    for hertz, order, expected in ((60, 1, 2e-6), (180, 3, 1e-6), (120, 2, 0.0)):
        tone = 2 * np.mean((wave - wave.mean(axis=0)) * np.exp(-2j * np.pi * hertz * t)[:, None], axis=0)
        assert np.abs(tone) == pytest.approx(expected * (1 + longer), abs=0.05e-6)
        if expected:
            assert np.angle(tone / tone[0]) == pytest.approx(order * (longer - longer[0]), abs=0.05)


@pytest.mark.campaign
def test_its_frequency_strays_by_20_mhz_and_comes_back(rk4: RigConfig) -> None:
    """Of 50 Hz: the phase of each second against an even clock moves by 2 pi 0.02 rad a second at most."""
    spec = FaultSpec(name="line_hum", parameters={"amount": 3e-5, "third": 0.0})
    plant = Plant(rk4, nameplate(rk4, faults=[spec]))
    wave = np.array([volts_of(plant, 1.0)[:, 0] for _ in range(60)])
    tone = 2 * np.mean((wave - wave.mean()) * np.exp(-2j * np.pi * 50 * np.arange(10_000) / 1e4), axis=1)
    hertz = np.diff(np.unwrap(np.angle(tone))) / (2 * np.pi)
    assert np.abs(hertz).max() == pytest.approx(0.02, rel=0.03)
    assert abs(hertz.mean()) < 2e-3
