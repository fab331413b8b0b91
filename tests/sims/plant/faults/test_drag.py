"""Drag grows with less than the square of the speed past oil that turns with the disk."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import drag

from ..by_hand import driven, ring_down


def test_a_ring_down_is_scipy_s_with_white_s_drag_coefficient(jeffcott: RigConfig) -> None:
    """m x'' + c_i x' + k x = -C v |v| (1 + 10 Re^(-2/3)), as large as 1000 v |v| at 30 mm/s, where Re = 22.5."""

    def rate(_: float, s: list[float]) -> tuple[float, float]:
        x, v = s
        power = (1 + 10 * (750.0 * abs(v) + 1e-12) ** (-2 / 3)) / (1 + 10 * 22.5 ** (-2 / 3))
        return v, -73.631e3 * x - 3e-6 * 73.631e3 * v - 1000.0 * v * abs(v) * power

    want = solve_ivp(rate, (0.0, 0.5), (1e-4, 0.0), t_eval=1e-4 * np.arange(1, 5001), rtol=1e-9, atol=1e-12).y[0]
    got = ring_down(jeffcott, "drag", {"coefficient": 1000.0}, amplitude=1e-4, seconds=0.5)
    assert np.abs(got).max() / np.abs(got[-300:]).max() > 4
    for part in (slice(0, 300), slice(2000, 2300), slice(4700, 5000)):
        assert np.abs(got[part]).max() == pytest.approx(np.abs(want[part]).max(), rel=0.02)


def test_a_whirl_with_the_oil_meets_less_of_it_than_one_against_it(rk4: RigConfig) -> None:
    """At 230 rad/s and a tenth of it in the oil: 0.9 and 1.1 of the speed past the oil."""
    (force,) = drag.forces(rk4, nameplate(rk4), drag.PARAMETERS)
    t = 1e-5 * np.arange(1, 4000)
    lost = []
    for sense in (1, -1):
        x, y = 1e-4 * np.cos(230 * t), sense * 1e-4 * np.sin(230 * t)
        f = driven(force, x, y, omega=230.0, step=1e-5)[100:-100]
        lost.append(np.hypot(*f.T).mean())
    past = 0.023 * np.array([0.9, 1.1])
    want = past**2 * (1 + 10 * (750 * past) ** (-2 / 3))
    assert lost[0] / lost[1] == pytest.approx(want[0] / want[1], rel=1e-3)
    assert lost[0] == pytest.approx(10.0 * want[0] / (1 + 10 * 22.5 ** (-2 / 3)), rel=1e-3)
