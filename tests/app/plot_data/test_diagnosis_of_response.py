"""What a diagnosis says of one response."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.diagnosis_of_response import extended_sigmas
from rotorrig.identify.diagnosis import Diagnosis


def test_half_the_residual_is_half_as_many_sigmas(named: Diagnosis) -> None:
    halved = dataclasses.replace(named, extended_residual=0.5j * named.residual)
    found = extended_sigmas(halved)
    assert found is not None
    assert found == pytest.approx(0.5 * named.sigmas, nan_ok=True)


def test_the_model_that_made_the_response_leaves_one_sigma(named: Diagnosis) -> None:
    found = extended_sigmas(named)
    assert found is not None
    assert np.sqrt(np.nanmean(found[:, :, 1] ** 2)) == pytest.approx(1.0, abs=0.03)  # 2960 vectors


def test_without_an_extended_model_there_are_none(poor: Diagnosis) -> None:
    assert extended_sigmas(poor) is None
