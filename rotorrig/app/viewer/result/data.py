"""A response with its fit, diagnosis and recording, arranged for the plots of the result view."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import WaveformSource
from rotorrig.app.plot_data import (
    CriticalSpeed,
    SpeedSpectra,
    check_balance_of,
    check_run_of,
    choose_resonances,
    critical_speeds,
    fits_of,
    model_vectors,
    part_of,
    predictions,
    slow_roll_known,
    speed_spectra,
    sweeps,
    vectors,
)
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.balancing import Balance
from rotorrig.identify import Diagnosis, Fit, Identification
from rotorrig.processing import OrderTrackedResponse, Plane, Waveforms, measured_planes
from rotorrig.processing.files import order_name
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

Vectors = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class Result:
    """A response and what is known of it. Vectors are 1X, (row, probe) [m], less the slow roll where that is known."""

    response: OrderTrackedResponse
    identification: Identification | None
    diagnosis: Diagnosis | None  # the part about this response
    recording: WaveformSource | None
    base: Vectors | None  # as the model without extension predicts
    extended: Vectors | None  # as the extended one does
    balance: Balance | None = None
    unit: AmplitudeUnit = AS_STATED  # in which amplitudes are told

    @property
    def fit(self) -> Fit | None:
        """The fit of the whole sweep."""
        return self.identification.fits[0] if self.identification and self.identification.fits else None

    @property
    def model(self) -> Vectors | None:
        """The best prediction there is."""
        return self.base if self.extended is None else self.extended

    @cached_property
    def z(self) -> Vectors:
        """Measured vectors, NaN where a row is not usable."""
        return np.where(self.response.usable, vectors(self.response), np.nan)

    @property
    def word(self) -> str:
        """Kind of the vectors, in a word."""
        if self.compensated:
            return "slow-roll compensated"
        return "compensated before it came" if np.isfinite(self.response.compensation_omega) else "raw"

    @property
    def compensated(self) -> bool:
        """Whether the vectors shown are less a slow roll that is known."""
        return slow_roll_known(self.response)

    @cached_property
    def sweeps(self) -> list[int]:
        """The runs whose speed changes."""
        return sweeps(self.response)

    @cached_property
    def critical_speeds(self) -> tuple[CriticalSpeed, ...]:
        """Critical speeds as measured, by probe and run, the model's beside them."""
        return critical_speeds(self.response, modelled=choose_resonances(self.fit, self.diagnosis))

    @cached_property
    def planes(self) -> list[tuple[Plane, list[int]]]:
        """The planes of which both probes were tracked, and where these stand among the probes."""
        return list(measured_planes(self.response.rig, self.response.probes))

    @cached_property
    def waveforms(self) -> Waveforms | None:
        """The waveforms of the recording; None without one."""
        return Waveforms(self.recording) if self.recording else None

    @cached_property
    def spectra(self) -> tuple[SpeedSpectra, ...]:
        """The recording's spectra over speed, run by run; none without a recording."""
        return speed_spectra(self.response, self.waveforms) if self.waveforms else ()

    @cached_property
    def rpm(self) -> NDArray[np.float64]:
        """Shaft speed of every row."""
        return self.response.omega * RPM

    @cached_property
    def fastest(self) -> float:
        """Upper end of speed axes [rpm]."""
        return 100.0 * float(np.ceil(self.rpm.max() / 100.0))


def result_of(
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    recording: WaveformSource | None = None,
    balance: Balance | None = None,
    *,
    unit: AmplitudeUnit = AS_STATED,
) -> Result:
    """Put together what belongs to `response`. Raises DataError if one of the others does not, or it has no 1X."""
    if 1.0 not in response.orders:
        orders = ", ".join(order_name(order) for order in response.orders)
        raise DataError(f"response: has the orders {orders}, want 1X among them: what is shown of a result is 1X")
    if recording is not None:
        check_run_of(recording, response)
    if balance:
        check_balance_of(balance, response)
    part = part_of(diagnosis, response) if diagnosis else None
    identification = fits_of(identification, response) if identification else None
    fit = identification.fits[0] if identification and identification.fits else None
    base, extended = predictions(response, fit, part)
    return Result(
        response=response,
        identification=identification,
        diagnosis=part,
        recording=recording,
        balance=balance,
        unit=unit,
        base=None if base is None else model_vectors(response, base),
        extended=None if extended is None else model_vectors(response, extended),
    )
