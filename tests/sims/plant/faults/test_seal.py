"""A seal damps in axes that turn with its liquid."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import seal

from ..by_hand import driven, growth

AT_DISK = {"damping": 10.0, "share": 0.5, "position": 0.2}
W = np.sqrt(73.631e3)  # rad/s, of the whirl
MATERIAL = 3e-6 * W**2  # N s/m of the shaft's own, which turns with all of the speed


@pytest.mark.parametrize("omega", [0.0, 200.0, 1000.0])
def test_forward_whirl_feels_its_damping_less_what_the_liquid_carries(jeffcott: RigConfig, omega: float) -> None:
    """D (w - share W) / w of it, of 1 kg; past w / share the liquid overtakes the whirl and feeds it."""
    for forward, sign in ((True, 1.0), (False, -1.0)):
        rate = growth(jeffcott, "seal", AT_DISK, omega=omega, forward=forward)
        felt = 10.0 * (1 - sign * 0.5 * omega / W)
        shaft = MATERIAL * (1 - sign * omega / W)
        assert rate == pytest.approx(-(27.13 + felt + shaft) / 2, rel=0.03)
        assert (felt < 0) == (forward and omega == 1000.0)


def test_a_shaft_that_whirls_as_fast_as_the_liquid_is_left_alone(rk4: RigConfig) -> None:
    (force,) = seal.forces(rk4, nameplate(rk4), AT_DISK)
    t = 1e-4 * np.arange(1, 2001)
    for whirl, lag in ((100.0, 0.0), (0.0, 100.0), (-50.0, 150.0)):
        z = 1e-4 * np.exp(1j * whirl * t)
        f = driven(force, z.real, z.imag, omega=200.0)[1:-1]
        # behind the liquid by `lag` rad/s, it is dragged along its orbit by D times that times its radius: 0.1 N; the
        # velocity, taken as a difference of neighbours, is (w h)^2 / 6 too small
        want = 10.0 * lag * 1j * z[1:-1]
        assert f[:, 0] + 1j * f[:, 1] == pytest.approx(want, abs=2e-6)
