"""What a diagnosis or a fit says of one response."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.diagnosis_of_response import extended_sigmas, fits_of
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError


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


def test_of_a_fit_of_several_responses_each_gets_its_own_rows(
    response: OrderTrackedResponse, identification: Identification
) -> None:
    other = dataclasses.replace(response, source=dataclasses.replace(response.source, source_hash="00" * 8))
    fit = identification.fits[0]
    shared = dataclasses.replace(
        identification,
        responses=tuple((r.source.source_hash, len(r.omega)) for r in (response, other)),
        fits=(dataclasses.replace(fit, prediction=np.concatenate([fit.prediction, 2 * fit.prediction])),),
    )
    for of, factor in ((response, 1), (other, 2)):
        found = fits_of(shared, of).fits[0].prediction
        np.testing.assert_array_equal(found, factor * fit.prediction)
    third = dataclasses.replace(response, source=dataclasses.replace(response.source, source_hash="ff" * 8))
    with pytest.raises(DataError, match="want the fit of this very response"):
        fits_of(shared, third)
