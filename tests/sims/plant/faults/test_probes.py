"""Probes that read wrong: gain, angle, curvature, cross-talk, each seen in phasors of a plain whirl."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

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


def test_neighbours_mix_their_signals(rk4: RigConfig) -> None:
    plain, wrong = pair(rk4, "cross_talk", {"share": 0.03, "probe": 3.0})
    assert wrong[2] == pytest.approx(plain[2] + 0.03 * plain[3], rel=2e-3)
    assert wrong[3] == pytest.approx(plain[3] + 0.03 * plain[2], rel=2e-3)
    assert wrong[:2] == pytest.approx(plain[:2], rel=1e-3)


def test_a_bent_scale_factor_makes_a_second_harmonic(rk4: RigConfig) -> None:
    """q x^2 / d of x = A cos(t) is q A^2 / (2 d) at twice the frequency, d = 300 um."""
    level = rk4.model_copy(update={"gravity": "none"})
    values = {"quadratic": 0.2, "cubic": 0.0, "probe": 0.0}
    plain = abs(steady(level, None, {}, rpm=2000)[0])
    _, second = pair(level, "probe_curvature", values, order=2)
    assert abs(second[0]) == pytest.approx(0.2 * plain**2 / (2 * 3e-4), rel=0.05)
    assert abs(second[2]) < 0.05 * abs(second[0])
