"""Probes that read wrong: gain, angle, curvature, cross-talk, each seen in phasors of a plain whirl."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_sensors
from rotorrig.sims.plant.sensors import VOLTS_PER_COUNT, Sensors, make_chain
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import steady


def pair(rig: RigConfig, name: str, values: dict[str, float], order: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return the phasors of the healthy rig and of the one with the fault at 2000 rpm."""
    return steady(rig, None, {}, rpm=2000, order=order), steady(rig, name, values, rpm=2000, order=order)


def test_a_gain_scales_one_probe(rk4: RigConfig) -> None:
    plain, wrong = pair(rk4, "probe_gain", {"gain": 0.05, "probe": 2.0})
    assert wrong / plain == pytest.approx([1, 1, 1.05, 1], rel=1e-3)


def test_a_turned_probe_sees_a_share_of_the_other_direction(rk4: RigConfig) -> None:
    """Towards a + turn: y cos - x sin for the probe at 90 degrees."""
    plain, wrong = pair(rk4, "probe_angle", {"turn": 0.1, "probe": 1.0})
    assert wrong[1] == pytest.approx(np.cos(0.1) * plain[1] - np.sin(0.1) * plain[0], rel=2e-3)
    assert wrong[[0, 2, 3]] == pytest.approx(plain[[0, 2, 3]], rel=1e-3)


def test_neighbours_mix_their_signals_the_more_the_wider_their_gaps(rk4: RigConfig) -> None:
    """3 % at the gap voltage; e times as much where the gaps are 2 mm wider together. Seen volt by volt."""
    truth = nameplate(rk4, faults=[FaultSpec(name="cross_talk", parameters={"share": 0.03, "probe": 3.0})])
    chain = apply_sensors(rk4, truth, make_chain(rk4, truth))
    at = np.array([[0.0, 0.0], [1e-4, -2e-4], [-4e-4, -4e-4], [5e-4, 5e-4]])
    motion = np.repeat(at[:, None, :], 4, axis=1)
    counts = Sensors(rk4, truth, chain, sample_rate=1e4).counts(motion, np.full(4, np.pi))
    shown = (counts[:, :4] * VOLTS_PER_COUNT + 10.0) / 7874.0
    share = 0.03 * np.exp(-at.sum(axis=1) / 2e-3)
    assert shown[:, 2] == pytest.approx(at[:, 0] + share * at[:, 1], abs=0.06e-6)
    assert shown[:, 3] == pytest.approx(at[:, 1] + share * at[:, 0], abs=0.06e-6)
    assert shown[:, :2] == pytest.approx(at, abs=0.06e-6)


def test_a_bent_scale_factor_makes_a_second_harmonic(rk4: RigConfig) -> None:
    """The reading's 2X over a circle, by the calibration table's own figures: 0.42 at 100 um, 0.76 at 200 um of it."""
    level = rk4.model_copy(update={"gravity": "none"})
    values = {"quadratic": 0.2, "cubic": 0.0, "probe": 0.0}
    plain = abs(steady(level, None, {}, rpm=2000)[0])
    assert plain < 1e-4  # where the table is straight: 0.42 per 100 um
    _, second = pair(level, "probe_curvature", values, order=2)
    # x (q 0.42 |x| / 1e-4) sign(x) = q 0.42 x^2 / 1e-4: half of it at 2X
    assert abs(second[0]) == pytest.approx(0.2 * 0.42 * plain**2 / 1e-4 / 2, rel=0.05)
    assert abs(second[2]) < 0.05 * abs(second[0])
