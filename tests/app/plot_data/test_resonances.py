"""Critical speeds of the closed form of tests/app/conftest.py: 2230 rpm, 4 % damping, e / (2 zeta) = 187.5 um."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.resonances import critical_speeds
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config import RPM


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
