"""Critical speeds of the closed form of tests/app/conftest.py: 2230 rpm, 4 % damping, e / (2 zeta) = 187.5 um."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app.plot_data.resonances import critical_speeds
from rotorrig.identify.identification import Identification
from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config import RPM
from rotorrig.rig.config.description import load

KFUPM = Path(__file__).parents[2] / "data" / "kfupm-rk4"
CONFIGS = Path(__file__).parents[3] / "configs"


def test_every_probe_and_run_has_the_critical_speed_of_the_rotor(
    response: OrderTrackedResponse, poorly_fitted: Identification
) -> None:
    found = critical_speeds(response, poorly_fitted.fits[0].prediction)
    assert [(each.probe, each.run) for each in found] == [
        (probe, run) for probe in response.probes for run in ("up", "down")
    ]
    for each in found:
        assert each.measured.omega.value * RPM == pytest.approx(2233.6, abs=3)  # 2230 / sqrt(1 - 2 * 0.04^2)
        assert each.measured.damping is not None
        assert each.measured.damping.value == pytest.approx(0.0403, abs=0.001)
        assert each.model is not None and each.model.damping is not None
        assert each.model.damping.value == pytest.approx(0.0555, abs=0.001)  # that fit has 5.5 %


def test_a_peak_the_model_has_not_stands_alone(response: OrderTrackedResponse) -> None:
    flat = np.full(response.z.shape[:2], 1e-6 + 0j)
    assert all(each.model is None for each in critical_speeds(response, flat))


def test_without_its_noise_no_peak_is_told_from_noise(response: OrderTrackedResponse) -> None:
    unknown = dataclasses.replace(response, covariance=np.full_like(response.covariance, np.nan))
    assert critical_speeds(unknown) == ()


def test_the_ripple_after_a_measured_run_up_is_no_critical_speed() -> None:
    """An RK4 passed its critical speed, near 1600 rpm, at 240 rpm/s: its peak comes late (docs/measured-run-up.md)."""
    rig = load(CONFIGS / "kfupm-rk4.toml")
    measured = read_table(KFUPM / "runup_bode_1037_2610rpm.csv", KFUPM / "mapping.toml", rig)
    (found,) = critical_speeds(measured)
    assert 1600 < found.measured.omega.value * RPM < 1700
