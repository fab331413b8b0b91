"""`OrderTrackedResponse`: vibration at shaft orders over speed.

Conventions (README): z = 2 mean(x e^{-j theta}), so x = Re(z e^{j theta}) with theta = 0 at the keyphasor edge;
metres, 0-peak; phase lag = -arg z. Order 0 holds the gap (mean position) as a real number.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import DataError, Provenance
from rotorrig.rig.config import RigConfig

Window = Literal[
    "blackman", "hann", "rectangular", "vold-kalman"
]  # weights of a row's turns, see docs/response-file.md
Method = Literal["resampling", "least-squares", "vold-kalman", "unknown"]  # of tracking; unknown: a table's


def _unknown() -> NDArray[np.float64]:
    return np.empty(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One passage of the rotor: a slow roll, a speed-up, a coast-down, with or without a known trial mass."""

    name: str
    direction: int  # +1 speed rises, -1 falls, 0 dwell
    #: disk -> kg m, angle from the keyphasor mark; on during the whole run, so in a slow roll of that recording too
    trial_unbalance: dict[str, complex] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class MainsHum:
    """Hum of the mains, or of a harmonic of theirs, as it was followed through a recording."""

    frequency: float  # Hz, nominal: 50, 60 or 2 or 3 times that
    t: NDArray[np.float64]  # (time,) s
    stray: NDArray[np.float64]  # (time,) rad, by how much its phase is ahead of 2 pi f t
    sigma: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))  # (time,) rad, of that; empty: not known
    #: (probe,) what each of them has of it, of mean square 1; empty: alike
    shares: NDArray[np.complex128] = field(default_factory=lambda: np.zeros(0, complex))


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderTrackedResponse:
    """Order vectors per speed row, raw; the slow-roll vector stands beside them and is never subtracted here.

    A table may have come compensated by a vector nobody kept: `compensation_omega` is then the speed of that.
    """

    rig: RigConfig
    probes: tuple[str, ...]
    orders: tuple[float, ...]  # 0 = gap, 1 = synchronous, 2, 0.5, -1 (backward)
    runs: tuple[Run, ...]
    run: NDArray[np.intp]  # (speed,) index into runs
    t: NDArray[np.float64]  # (speed,) s, middle of the row's window on the recording's clock; NaN: unknown
    omega: NDArray[np.float64]  # (speed,) rad/s, in the middle of the window
    alpha: NDArray[np.float64]  # (speed,) rad/s^2; NaN: unknown
    revolutions: NDArray[np.float64]  # (speed,) length of the row's window in turns
    window: Window  # the weights of the turns in a row, the tracking filter's smear
    z: NDArray[np.complex128]  # (speed, probe, order) m, 0-peak, raw
    covariance: NDArray[np.float64]  # (speed, order, 2 probe, 2 probe) m^2 of (re z_1, im z_1, re z_2, ...)
    slow_roll: NDArray[np.complex128]  # (probe, order) m; NaN where there is none
    slow_roll_covariance: NDArray[np.float64]  # (order, 2 probe, 2 probe) m^2
    slow_roll_omega: float  # rad/s; NaN: no slow roll
    usable: NDArray[np.bool_]  # (speed, probe)
    reasons: tuple[tuple[str, ...], ...]  # (speed,) why a probe of the row is not usable: "1x: clipped"
    keyphasor_t: NDArray[np.float64]  # (pulse,) s, the edge of every turn by the smooth shaft angle; empty: unknown
    source: Provenance
    #: rad/s, of the slow roll whose vector z lacks, as its table was compensated and did not say by what; NaN: z is raw
    compensation_omega: float = float("nan")
    #: whether t and keyphasor_t were derived from speeds and a ramp: they give the right speeds, but no beat with the
    #: mains; False: they are a clock's, or a sum of consecutive revolutions
    derived_times: bool = False
    #: whether its table had no phases: z is then the amplitude, real, and its variance that of an amplitude
    amplitudes_alone: bool = False
    mains: tuple[MainsHum, ...] = ()  # that were found in the waveforms: vectors have them, the covariance has not
    method: Method = "unknown"
    omega_sigma: NDArray[np.float64] = field(default_factory=_unknown)  # (speed,) rad/s, 1 sigma; empty: unknown
    alpha_sigma: NDArray[np.float64] = field(default_factory=_unknown)  # (speed,) rad/s^2, 1 sigma; empty: unknown
    #: (speed,) s, 1 sigma of a single keyphasor edge about the smooth shaft angle; empty: unknown
    jitter: NDArray[np.float64] = field(default_factory=_unknown)
    remarks: tuple[tuple[str, ...], ...] = ()  # (speed,) worth knowing of a usable row: "line interference, 50 Hz"
    slow_roll_remarks: tuple[str, ...] = ()  # what speaks against the slow roll; empty: nothing
    #: (probe, point) m, mean taken out, at equal steps of shaft angle from the keyphasor edge; empty: none
    slow_roll_waveform: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def slow_omega(self) -> float:
        """Speed of the slow roll that was measured, or of the one that was subtracted [rad/s]; NaN: neither."""
        return self.slow_roll_omega if np.isfinite(self.slow_roll_omega) else self.compensation_omega

    @property
    def read(self) -> tuple[str, ...]:
        """The probes with a usable row: a table may lack some of the config's."""
        good = np.asarray(self.usable.any(axis=0))
        return tuple(name for name, some in zip(self.probes, good, strict=True) if some)

    def rate(self, run: int) -> float:
        """Return the median acceleration of a run [rad/s^2], negative where the speed falls; 0 where it is unknown."""
        known = self.alpha[(self.run == run) & np.isfinite(self.alpha)]
        return float(np.median(known)) if known.size else 0.0

    def order(self, order: float) -> NDArray[np.complex128]:
        """Return z at one order, (speed, probe)."""
        return self.z[:, :, self.orders.index(order)]

    def compensated(self, order: float = 1.0) -> NDArray[np.complex128]:
        """Return z at one order less the slow-roll vector, (speed, probe); NaN without a slow roll."""
        return self.order(order) - self.slow_roll[:, self.orders.index(order)]


def require_phases(responses: Iterable[OrderTrackedResponse], what: str) -> None:
    """Raise DataError if one of the responses has amplitudes alone, as `what`, "a diagnosis", wants phases."""
    for response in responses:
        if response.amplitudes_alone:
            name = response.source.source or "response"
            raise DataError(f"{name}: was imported as amplitudes without phases, and {what} wants phases too")
