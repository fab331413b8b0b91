"""The orders of a bent scale, and of products with the motion across, are those of their Fourier series."""

import numpy as np
import pytest

from rotorrig.identify.extended_model.probe_curve import CURVED_AT, POWERS, ProbeCurves, bend
from rotorrig.rig.config import RigConfig

THETA = 2 * np.pi * np.arange(64) / 64
FIRST = np.array([[180e-6 * np.exp(0.7j), 420e-6 * np.exp(-2.1j)]])  # one row of two probes


def fourier(values: np.ndarray, order: int) -> complex:
    return 2 * np.mean(values * np.exp(-1j * order * THETA))


@pytest.mark.parametrize("power", POWERS)
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("first", [180e-6 * np.exp(0.7j), 420e-6 * np.exp(-2.1j)])
def test_an_order_is_the_fourier_coefficient_of_the_power(power: int, order: int, first: complex) -> None:
    r = np.real(first * np.exp(1j * THETA)) / CURVED_AT
    assert bend(np.array([first]), order, power)[0] == pytest.approx(CURVED_AT * fourier(r**power, order), abs=1e-15)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_what_all_coefficients_add_is_that_of_readings_in_time(rig: RigConfig, order: int) -> None:
    curves = ProbeCurves(rig, ("1x", "1y"))
    shares = np.linspace(-0.03, 0.05, len(curves.names))
    x, y = np.real(FIRST[0, :, None] * np.exp(1j * THETA)) / CURVED_AT
    of = dict(zip(curves.names, shares, strict=True))
    for probe, (name, r, s) in enumerate((("1x", x, y), ("1y", y, x))):
        added = sum(of[f"curvature {name} r^{power}"] * r**power for power in POWERS)
        added += of[f"curvature {name} r s"] * r * s + of[f"curvature {name} s^2"] * s**2
        expected = CURVED_AT * fourier(added, order)
        assert curves.bend(shares, FIRST, order)[0, probe] == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_changes_are_the_derivative(rig: RigConfig, order: int) -> None:
    curves = ProbeCurves(rig, ("1x", "1y"))
    shares = np.linspace(-0.03, 0.05, len(curves.names))
    step = 1e-9 * np.array([[1 - 2j, 0.5 + 1j]])
    ahead, behind = (curves.bend(shares, FIRST + sign * step, order) for sign in (1, -1))
    found = curves.changes(shares, FIRST, step[..., None], order)[..., 0]
    assert found == pytest.approx((ahead - behind) / 2, rel=1e-6, abs=1e-16)


def test_every_probe_has_a_coefficient_of_every_power_and_of_the_products_with_the_probe_across(rig: RigConfig) -> None:
    names = ProbeCurves(rig, ("1x", "1y")).names
    assert names[:3] == ["curvature 1x r^2", "curvature 1y r^2", "curvature 1x r^3"]
    assert names[-4:] == ["curvature 1x r s", "curvature 1y r s", "curvature 1x s^2", "curvature 1y s^2"]


def test_a_probe_without_another_across_it_has_no_products(rig: RigConfig) -> None:
    assert len(ProbeCurves(rig, ("1x", "2y")).names) == 2 * len(POWERS)


def test_a_thin_shaft_curves_away_more(rig: RigConfig) -> None:
    curves = ProbeCurves(rig, ("1x", "1y"))
    at_300_um = curves.prior_sigma[-1] * 300e-6
    assert 300e-6**2 / 0.010 / 4 < at_300_um < 300e-6**2 / 0.010  # s^2 / 2R, of which a tip sees a part
