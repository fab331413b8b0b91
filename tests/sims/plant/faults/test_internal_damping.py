"""Damping that turns with the shaft, and takes its time."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig

from ..by_hand import growth

W = np.sqrt(73.631e3)
TIME, RELAXATION = 3e-4, 460.0


def eigenvalue(omega: float, *, forward: bool) -> complex:
    """Return s of m = 1 kg on the damper, the shaft, its material's own damping and the lag, by Newton's method.

    What turns with the shaft sees a whirl of e^{s t} as e^{(s - j W) t}.
    """
    k = 73.631e3

    def balance(s: complex) -> complex:
        seen = s - 1j * omega
        return s * s + 27.13 * s + k * (1 + 3e-6 * seen + 2 * TIME * RELAXATION * seen / (seen + RELAXATION))

    s = complex(0.0, W if forward else -W)
    for _ in range(50):
        s -= balance(s) / ((balance(s + 1e-4) - balance(s - 1e-4)) / 2e-4)
    return s


@pytest.mark.parametrize("ratio", [0.5, 1.7, 3.0])
def test_forward_whirl_is_driven_where_the_shaft_turns_faster(jeffcott: RigConfig, ratio: float) -> None:
    rate = growth(jeffcott, "internal_damping", {"time": TIME}, omega=ratio * W, forward=True)
    assert rate == pytest.approx(eigenvalue(ratio * W, forward=True).real, rel=0.05, abs=0.05)
    assert (rate > 0) == (ratio == 3.0)


def test_backward_whirl_moves_fast_in_the_shaft_and_is_damped_the_less_for_it(jeffcott: RigConfig) -> None:
    rate = growth(jeffcott, "internal_damping", {"time": TIME}, omega=W, forward=False)
    assert rate == pytest.approx(eigenvalue(W, forward=False).real, rel=0.05)
    kimball = -(27.13 + 2 * (TIME + 3e-6) * 73.631e3) / 2
    assert kimball < 0.9 * rate
