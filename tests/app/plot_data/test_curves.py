"""What gets drawn is the closed form the response was made of, see conftest.py."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.curves import curves, lag_degrees, phase_window, residual_grid, whirl_grid
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.processing.response import OrderTrackedResponse


def test_bode_curves_are_the_closed_form_with_the_runout_gone(response: OrderTrackedResponse) -> None:
    up = curves(response, 0)[0]
    peak = int(np.argmax(up.amplitude))
    assert up.amplitude[peak] == pytest.approx(187.5, abs=1.5)  # e / (2 zeta), noise 0.3
    assert up.rpm[peak] == pytest.approx(2230, abs=10)
    assert np.interp(2230, up.rpm, up.lag) % 360 == pytest.approx(
        50, abs=1
    )  # 90 at resonance, less the 40 of the unbalance
    assert up.sigma == pytest.approx(0.3)


def test_masked_rows_leave_a_hole_in_the_curve(response: OrderTrackedResponse) -> None:
    usable = response.usable.copy()
    usable[20, 0] = False
    up = curves(dataclasses.replace(response, usable=usable), 0)[0]
    assert np.flatnonzero(np.isnan(up.amplitude)).tolist() == [10]  # ten rows of slow roll stand before the run


def test_a_phase_curve_is_not_cut_at_the_axis_end() -> None:
    lags = np.linspace(330, 330 + 180, 50)
    z = np.exp(-1j * np.radians(lags))
    drawn = lag_degrees(z, start=phase_window(z))
    assert np.abs(np.diff(drawn)).max() < 10


def test_residual_map_is_red_at_resonance_for_wrong_damping_only(
    response: OrderTrackedResponse, good: Diagnosis, poor: Diagnosis
) -> None:
    labels, edges, grid = residual_grid(response, poor.sigmas)
    at = int(np.searchsorted(edges, 2230)) - 1
    assert labels[:2] == ["1x up", "1x down"]
    assert (grid[:, at] > 30).all()
    assert np.nanmax(residual_grid(response, good.sigmas)[2]) < 3.5


def test_the_whirl_of_a_residual_is_drawn_by_plane_run_and_sense(
    response: OrderTrackedResponse, poor: Diagnosis
) -> None:
    x, y = (response.probes.index(name) for name in ("1x", "1y"))
    residual = np.zeros_like(poor.residual)
    residual[:, x, response.orders.index(1.0)] = 3e-6
    residual[:, y, response.orders.index(1.0)] = 3e-6j  # x leads: y moves a quarter of a turn before it
    labels, _, grid = whirl_grid(response, residual)
    rows = dict(zip(labels, grid, strict=True))
    assert labels[:4] == ["1x+1y up, forward", "1x+1y up, backward", "1x+1y down, forward", "1x+1y down, backward"]
    assert np.nanmax(rows["1x+1y up, forward"]) < 1e-9
    assert np.nanmin(rows["1x+1y up, backward"]) == pytest.approx(3)
