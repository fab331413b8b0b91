"""What a diagnosis or a fit says of one response."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.diagnosis_of_response import fits_of, part_of
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError


def test_of_a_diagnosis_of_several_responses_each_gets_its_own_rows(
    response: OrderTrackedResponse, named: Diagnosis
) -> None:
    other = dataclasses.replace(response, source=dataclasses.replace(response.source, source_hash="00" * 8))
    assert named.extended_residual is not None and named.extended_sigmas is not None
    shared = dataclasses.replace(
        named,
        responses=tuple((r.source.source_hash, len(r.omega)) for r in (response, other)),
        residual=np.concatenate([named.residual, 2 * named.residual]),
        sigmas=np.concatenate([named.sigmas, 2 * named.sigmas]),
        extended_residual=np.concatenate([named.extended_residual, 2 * named.extended_residual]),
        extended_sigmas=np.concatenate([named.extended_sigmas, 2 * named.extended_sigmas]),
    )
    for of, factor in ((response, 1), (other, 2)):
        part = part_of(shared, of)
        for name in ("residual", "sigmas", "extended_residual", "extended_sigmas"):
            np.testing.assert_array_equal(getattr(part, name), factor * getattr(named, name))


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
