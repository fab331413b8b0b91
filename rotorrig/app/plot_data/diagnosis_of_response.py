"""The part of a diagnosis, or of an identification, that is about one response; whether a balance or a run is of it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import WaveformSource
from rotorrig.balancing import Balance
from rotorrig.identify import Diagnosis, Fit, Identification, ModelResonance
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError

Vectors = NDArray[np.complex128]


def part_of(diagnosis: Diagnosis, response: OrderTrackedResponse) -> Diagnosis:
    """Return the part of a diagnosis that is about `response`. Raises DataError if it is of another."""
    number, mine = _place_of(diagnosis.responses, response, what="diagnosis")
    if diagnosis.sigmas[mine].shape != response.z.shape:
        raise DataError(
            f"diagnosis: residual is (speed, probe, order) = {diagnosis.sigmas[mine].shape}, the response has "
            f"{response.z.shape}; want the diagnosis of this very response"
        )
    after, after_sigmas = diagnosis.extended_residual, diagnosis.extended_sigmas
    return replace(
        diagnosis,
        residual=diagnosis.residual[mine],
        sigmas=diagnosis.sigmas[mine],
        extended_residual=None if after is None else after[mine],
        extended_sigmas=None if after_sigmas is None else after_sigmas[mine],
        resonances=_of_response(diagnosis.resonances, number),
    )


def fits_of(identification: Identification, response: OrderTrackedResponse) -> Identification:
    """Return the part of an identification that is about `response`. Raises DataError if it is of another."""
    only = ((identification.source.source_hash, len(response.omega)),)  # of an older file
    number, mine = _place_of(identification.responses or only, response, what="fit")
    fits = tuple(
        replace(fit, prediction=fit.prediction[mine], resonances=_of_response(fit.resonances, number))
        for fit in identification.fits
    )
    for fit in fits:
        if fit.prediction.shape != response.z.shape[:2]:
            raise DataError(
                f"fit '{fit.name}': predicts (speed, probe) = {fit.prediction.shape}, the response has "
                f"{response.z.shape[:2]}; want the fit of this very response"
            )
    return replace(identification, fits=fits)


def _of_response(resonances: Sequence[ModelResonance], number: int) -> tuple[ModelResonance, ...]:
    return tuple(each for each in resonances if each.response == number)


def _place_of(responses: Sequence[tuple[str, int]], response: OrderTrackedResponse, *, what: str) -> tuple[int, slice]:
    """Return the number of `response` among those of a result, and its rows there."""
    if not responses:  # of an older file: of one response
        return 0, slice(None)
    first = 0
    for number, (source, rows) in enumerate(responses):
        if source == response.source.source_hash:
            return number, slice(first, first + rows)
        first += rows
    raise DataError(
        f"{what}: is of {', '.join(source for source, _ in responses)}, the response is of "
        f"{response.source.source_hash} ({response.source.source}); want the {what} of this very response"
    )


def check_balance_of(balance: Balance, response: OrderTrackedResponse) -> None:
    """Raise DataError if a balance is not of `response`, its first: the rotor as it was before."""
    if balance.source.source_hash != response.source.source_hash:
        raise DataError(
            f"balance: is of {balance.source.source_hash} ({balance.source.source}), the response is of "
            f"{response.source.source_hash} ({response.source.source}); want the first response it was made of"
        )


def check_run_of(recording: WaveformSource, response: OrderTrackedResponse) -> None:
    """Raise DataError if `response` was tracked from another recording."""
    if recording.source.source_hash != response.source.source_hash:
        raise DataError(
            f"run: is of {recording.source.source_hash} ({recording.source.source}), the response is of "
            f"{response.source.source_hash} ({response.source.source}); want the run of this very response"
        )


def predictions(
    response: OrderTrackedResponse, fit: Fit | None, diagnosis: Diagnosis | None
) -> tuple[Vectors | None, Vectors | None]:
    """Return 1X as the base model and as the extended model predict it, (speed, probe) [m]; None where there is none.

    `diagnosis` is the part of the diagnosis that is about `response`.
    """
    measured, place = response.order(1.0), response.orders.index(1.0)
    base = fit.prediction if fit else measured - diagnosis.residual[:, :, place] if diagnosis else None
    after = diagnosis.extended_residual if diagnosis else None
    return base, None if after is None else measured - after[:, :, place]


def choose_resonances(fit: Fit | None, diagnosis: Diagnosis | None) -> tuple[ModelResonance, ...]:
    """Return those of the extended model if there is one, else of the base; both results cut to one response."""
    if diagnosis and (diagnosis.extended_residual is not None or fit is None):
        return diagnosis.resonances
    return fit.resonances if fit else ()
