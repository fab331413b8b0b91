"""Critical speeds as people read them, and whether they keep clear of the operating speeds."""

import dataclasses

from rotorrig.app.text.resonances import critical_speed_cells, margin_text, resonance_text
from rotorrig.processing.resonance import Resonance, Uncertain
from rotorrig.processing.settings import SpeedWindow
from rotorrig.rig.config import RPM


def exactly(value: float, sigma: float = float("nan")) -> Uncertain:
    return Uncertain(value=value, sigma=sigma)


PEAK = Resonance(
    omega=exactly(2000 / RPM, 0.5 / RPM),
    amplitude=exactly(1e-4),
    lower=exactly(1950 / RPM),
    upper=exactly(2050 / RPM),
    amplification=exactly(20.0, 0.15),
    damping=exactly(0.025, 0.0002),
)
END_OF_SWEEP = dataclasses.replace(PEAK, upper=None, amplification=None, damping=None)


def window(low: float, high: float) -> SpeedWindow:
    return SpeedWindow(low / RPM, high / RPM)


def test_values_carry_their_sigma() -> None:
    assert critical_speed_cells(PEAK) == ["2000.00 ± 0.50", "20.00 ± 0.15", "2.500 ± 0.020"]
    assert critical_speed_cells(END_OF_SWEEP) == ["2000.00 ± 0.50", "–", "–"]
    assert resonance_text(PEAK) == "2000 rpm, AF 20, ζ 2.5 %"
    assert resonance_text(END_OF_SWEEP) == "2000 rpm"


def test_the_margin_is_of_the_operating_speed_nearest_to_the_critical_one() -> None:
    assert margin_text(PEAK, window(2500, 3000)) == "20.0 %, wanted 16.0 %"  # 500 / 2500; AF 20: at most 16
    assert margin_text(PEAK, window(2100, 3000)) == "4.8 %, wanted 16.0 %: too small"
    assert margin_text(PEAK, window(1000, 1250)) == "60.0 %, wanted 26.0 %"  # 750 / 1250, above the operating speeds
    assert margin_text(PEAK, window(1900, 2100)) == "0.0 %, wanted 16.0 %: too small"
    assert margin_text(END_OF_SWEEP, window(2500, 3000)) == "20.0 %, wanted: unknown without AF"
