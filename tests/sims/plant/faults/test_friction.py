"""Dry friction takes the same off every swing, and then holds."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import friction

from ..by_hand import driven, ring_down


def test_swings_lose_four_times_the_limit_over_the_stiffness_each(jeffcott: RigConfig) -> None:
    """Energy 4 F A per cycle out of k A^2 / 2 (Den Hartog, Mechanical Vibrations); F / k = 1.36 um."""
    values = {"limit": 0.1, "stuck_stiffness": 2e6}
    x = ring_down(jeffcott, "friction", values, amplitude=1e-4, seconds=0.8)
    peaks = x[1:-1][(x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]) & (x[1:-1] > 2e-5)]
    material = 1 - np.exp(-3e-6 * 73.631e3 / 2 * 2 * np.pi / np.sqrt(73.631e3))  # of the amplitude, per cycle
    lost = -np.diff(peaks) - material * peaks[:-1]
    assert lost.mean() == pytest.approx(4 * 0.1 / 73.631e3, rel=0.03)
    assert lost.std() < 0.05 * lost.mean()  # the same from every swing, unlike a viscous damper
    assert np.ptp(x[-300:]) < 3e-6  # less than the band within which it sticks


def test_the_bristles_bend_as_scipy_says_of_the_paper_s_equation(rk4: RigConfig) -> None:
    """z' = v - s |v| z / g(v), g = F (1 + 0.2 exp(-(v / 1 mm/s)^2)), 5 um at 5 Hz: it sticks and slides."""
    (force,) = friction.forces(rk4, nameplate(rk4), {"limit": 0.05, "stuck_stiffness": 1e5})
    step, w = 1e-5, 2 * np.pi * 5

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        v = 5e-6 * w * np.cos(w * t)
        return v - 1e5 * abs(v) * z / (0.05 * (1 + 0.2 * np.exp(-((v / 1e-3) ** 2))))

    t = step * np.arange(1, 40_001)
    want = -1e5 * solve_ivp(rate, (0.0, 0.4), [0.0], t_eval=t, max_step=1e-3, rtol=1e-8, atol=1e-14).y[0]
    got = driven(force, 5e-6 * np.sin(w * t), step=step)[:, 0]
    assert np.abs(got - want).max() < 0.01 * 0.05
    assert np.abs(got).max() == pytest.approx(0.06, rel=0.03)  # slower than Stribeck's speed: all of the stiction


def test_it_follows_like_a_spring_until_it_slides_and_slides_against_the_motion(rk4: RigConfig) -> None:
    (force,) = friction.forces(rk4, nameplate(rk4), {"limit": 0.05, "stuck_stiffness": 1e5})
    t = 1e-5 * np.arange(1, 2001)
    assert driven(force, 1e-8 * t / t[-1], step=1e-5)[-1, 0] == pytest.approx(-1e-3, rel=0.02)
    along, aside = driven(force, 0.03 * t, 0.04 * t, step=1e-5)[-1]  # 50 mm/s
    assert (along, aside) == pytest.approx((-0.03, -0.04), rel=1e-6)
