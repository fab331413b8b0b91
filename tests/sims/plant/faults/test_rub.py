"""A ring round the shaft that yields and creeps back."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import rub

from ..by_hand import driven, steady

RING = {"stiffness": 1e4, "gap": 1e-4, "friction": 0.1, "position": 0.32}
CREEP = 5e-4  # s
STEP = 1e-5


def test_pushed_slowly_it_pushes_back_beyond_the_gap_and_drags_against_the_rotation(rk4: RigConfig) -> None:
    (ring,) = rub.forces(rk4, nameplate(rk4), RING)
    slowly = np.linspace(0.0, 3e-4, 40_000)
    pushed = driven(ring, slowly, omega=100.0, step=STEP)
    assert np.all(pushed[slowly < 1e-4] == 0.0)
    # 0.5 m/s of slip at 100 rad/s on a radius of 5 mm: full friction, along -y at the +x side of a shaft from x to y;
    # 0.75 mm/s through rubber of 1e4 * 5e-4 N s/m adds 4 mN
    assert pushed[-1] == pytest.approx((-2.00375, -0.200375), rel=1e-3)
    upwards = driven(ring, np.zeros(40_000), slowly, omega=100.0, step=STEP)[-1]
    assert upwards == pytest.approx((0.200375, -2.00375), rel=1e-3)
    assert driven(ring, np.zeros(40_000), slowly, omega=-100.0, step=STEP)[-1, 0] == pytest.approx(-0.200375, rel=1e-3)


def test_a_shaft_that_returns_at_once_finds_the_ring_further_off(rk4: RigConfig) -> None:
    """Pushed in by 80 um and let go, it stands at 80 exp(-t / 0.5 ms) um: the gap is wider by as much."""
    (ring,) = rub.forces(rk4, nameplate(rk4), RING)
    after = 7e-4  # s
    slowly = np.linspace(0.0, 1.8e-4, 20_000)
    away = np.zeros(round(after / STEP) - 1)
    ahead = 1e-4 + 8e-5 * np.exp(-after / CREEP)
    for x, touches in ((0.97 * ahead, False), (1.03 * ahead, True)):
        got = driven(ring, np.concatenate([slowly, away, [x]]), step=STEP)
        assert np.all(got[len(slowly) : -1] == 0.0)
        assert (got[-1, 0] < 0.0) == touches


def test_on_a_steady_circle_it_is_a_spring_and_a_dashpot(rk4: RigConfig) -> None:
    """Without friction, k (1 + j w CREEP) times how far the ring is pushed, across the gap."""
    (ring,) = rub.forces(rk4, nameplate(rk4), RING | {"friction": 0.0})
    w, radius = 230.0, 3e-4
    t = STEP * np.arange(1, 30_000)
    z = radius * np.minimum(t / 0.1, 1.0) * np.exp(1j * w * t)
    fx, fy = driven(ring, z.real, z.imag, step=STEP)[-1]
    # the ring's place, r - gap along the push n; the push is k (1 + j w CREEP) of it, and along n
    lag = np.arctan(w * CREEP)
    pushed = complex(-fx, -fy)
    in_ring = pushed / (1e4 * (1 + 1j * w * CREEP))
    assert abs(z[-1] - in_ring) == pytest.approx(1e-4, rel=5e-3)  # the gap between ring and shaft
    assert np.angle((z[-1] - in_ring) / pushed) == pytest.approx(0.0, abs=5e-3)  # and the push lies along it
    assert np.angle(pushed / in_ring) == pytest.approx(lag, rel=1e-6)


def test_a_whirl_that_would_pass_the_gap_is_held_near_it(rk4: RigConfig) -> None:
    free, held = (abs(steady(rk4, "rub", RING | {"stiffness": k}, rpm=2150)[0]) for k in (0.0, 5e4))
    assert free > 1.2e-4
    assert held < 1.1e-4
    assert np.isfinite(held)
