"""The sideways push of a bearing feeds forward whirl."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import growth


@pytest.mark.parametrize(("share", "grows"), [(0.93, False), (1.07, True)])
def test_forward_whirl_grows_beyond_damping_times_its_frequency(jeffcott: RigConfig, share: float, grows: bool) -> None:
    """Energy in per turn is pi k_s r^2 * 2, out c w r^2 * 2 pi: the limit is c w, c with the material's 0.22 N s/m."""
    limit = (27.13 + 3e-6 * 73.631e3) * np.sqrt(73.631e3)
    rate = growth(jeffcott, "skew_stiffness", {"stiffness": share * limit}, omega=0.0, forward=True)
    assert rate == pytest.approx((share - 1) * 27.35 / 2, rel=0.05)
    assert (rate > 0) == grows


def test_backward_whirl_is_damped_by_it(jeffcott: RigConfig) -> None:
    limit = 27.35 * np.sqrt(73.631e3)
    rate = growth(jeffcott, "skew_stiffness", {"stiffness": 0.5 * limit}, omega=0.0, forward=False)
    assert rate == pytest.approx(-1.5 * 27.35 / 2, rel=0.05)
