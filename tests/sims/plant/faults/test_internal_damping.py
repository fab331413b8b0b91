"""Damping that turns with the shaft."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import growth

W = np.sqrt(73.631e3)


@pytest.mark.parametrize("ratio", [0.5, 2.0, 2.5])
def test_forward_whirl_grows_above_the_speed_kimball_found(jeffcott: RigConfig, ratio: float) -> None:
    """The rate is -(ce + ci (1 - W/w)) / 2m: zero at W = w (1 + ce / ci), here 2.21 w."""
    inner = (3e-4 + 3e-6) * 73.631e3  # with the material's own
    rate = growth(jeffcott, "internal_damping", {"time": 3e-4}, omega=ratio * W, forward=True)
    assert rate == pytest.approx(-(27.13 + inner * (1 - ratio)) / 2, rel=0.05)
    assert (rate > 0) == (ratio > 1 + 27.13 / inner)


def test_backward_whirl_is_damped_the_more_the_faster_it_turns(jeffcott: RigConfig) -> None:
    inner = (3e-4 + 3e-6) * 73.631e3
    rate = growth(jeffcott, "internal_damping", {"time": 3e-4}, omega=W, forward=False)
    assert rate == pytest.approx(-(27.13 + inner * 2) / 2, rel=0.05)
