"""The sideways push of a bearing's seal feeds forward whirl, the more the faster the shaft turns."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import growth

LIMIT = (27.13 + 3e-6 * 73.631e3) * np.sqrt(73.631e3)  # c w, c with the material's 0.22 N s/m


@pytest.mark.parametrize(("share", "omega"), [(0.93, 230.0), (1.07, 230.0), (0.535, 460.0)])
def test_forward_whirl_grows_beyond_damping_times_frequency(jeffcott: RigConfig, share: float, omega: float) -> None:
    """Energy in per turn is pi k_s r^2 * 2, out c w r^2 * 2 pi; twice as fast twice the push."""
    rate = growth(jeffcott, "skew_stiffness", {"stiffness": share * LIMIT}, omega=omega, forward=True)
    pushed = share * omega / 230.0
    material = 3e-6 * 73.631e3 * omega / np.sqrt(73.631e3) / 2  # which turns too
    assert rate == pytest.approx((pushed - 1) * 27.35 / 2 + material, rel=0.08)
    assert (rate > 0) == (share != 0.93)


def test_backward_whirl_is_damped_by_it(jeffcott: RigConfig) -> None:
    rate = growth(jeffcott, "skew_stiffness", {"stiffness": 0.5 * LIMIT}, omega=230.0, forward=False)
    material = 3e-6 * 73.631e3 * 230.0 / np.sqrt(73.631e3) / 2
    assert rate == pytest.approx(-1.5 * 27.35 / 2 - material, rel=0.05)
