"""The orders of a bent scale are those of its Fourier series."""

import numpy as np
import pytest

from rotorrig.identify.extended_model.probe_curve import CURVED_AT, POWERS, bend, curve_names

THETA = 2 * np.pi * np.arange(64) / 64


@pytest.mark.parametrize("power", POWERS)
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("first", [180e-6 * np.exp(0.7j), 420e-6 * np.exp(-2.1j)])
def test_an_order_is_the_fourier_coefficient_of_the_power(power: int, order: int, first: complex) -> None:
    r = np.real(first * np.exp(1j * THETA)) / CURVED_AT
    expected = 2 * CURVED_AT * np.mean(r**power * np.exp(-1j * order * THETA))
    assert bend(np.array([first]), order, power)[0] == pytest.approx(expected, abs=1e-15)


def test_every_probe_has_a_coefficient_of_every_power() -> None:
    assert curve_names(("1x", "1y"))[:3] == ["curvature 1x r^2", "curvature 1y r^2", "curvature 1x r^3"]
    assert len(curve_names(("1x", "1y"))) == 2 * len(POWERS)
