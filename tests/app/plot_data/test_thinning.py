"""What a thinned curve keeps."""

import numpy as np
import pytest

from rotorrig.app.plot_data.curves import Curve
from rotorrig.app.plot_data.thinning import thin_curve, thin_indices


def test_a_short_run_is_drawn_whole() -> None:
    assert thin_indices(np.zeros(7), most=8).tolist() == list(range(7))


def test_a_spike_of_one_row_in_twenty_thousand_is_kept() -> None:
    values = np.zeros(20_000)
    values[12_345], values[7] = 9.0, -9.0
    rows = thin_indices(values, most=500)
    assert len(rows) <= 500
    assert {12_345, 7} <= set(rows.tolist())


def test_a_hole_stays_a_hole() -> None:
    values = np.ones(1000)
    values[400:600] = np.nan
    drawn = values[thin_indices(values, most=100)]
    assert np.isnan(drawn).sum() == pytest.approx(10, abs=1)  # a fifth of 50 stretches, a row each


def test_all_of_a_curve_is_thinned_alike() -> None:
    n = 5000
    rpm = np.linspace(500.0, 4000.0, n)
    curve = Curve(
        run="up", direction=1, rpm=rpm, amplitude=rpm / 100, lag=rpm / 50, sigma=np.ones(n),
        model_amplitude=-((rpm - 1000) ** 2), model_lag=None,
    )  # fmt: skip
    few = thin_curve(curve, most=100)
    assert few.amplitude == pytest.approx(few.rpm / 100)
    assert few.lag == pytest.approx(few.rpm / 50)
    by_model = thin_curve(curve, most=100, modelled=True)
    assert np.abs(by_model.rpm - 1000).min() < 1  # the model's own peak
