"""Validity of a slow roll: whether 1X in it is run-out, or already response to unbalance; remarks with numbers.

Run-out does not change with the speed, the response to unbalance does: at low speed by Omega^2 / (1 - (Omega / w)^2),
with w the speed at which 1X is largest. A straight line of the low-speed rows over that says how much of the slow-roll
vector is response, with its uncertainty (a bow, which is response too, grows by the same law from a value of its own).
Nothing is masked or corrected for it here: a model tells the two apart.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.slow_roll.vector import SlowRoll
from rotorrig.rig.config import RPM, micrometres

SLOW = 0.25  # of the speed of the largest 1X: there an unbalance still moves the shaft by 1/15 of its eccentricity
LOW = 0.5  # of that speed: rows below it are in the fit
LOW_MULTIPLE = 4.0  # of the slow-roll speed, where no largest 1X is known
FEWEST = 5  # rows of a fit
APART = 1.3  # highest to lowest speed of a fit
SIGNIFICANT = 4.0  # sigma: in one of 3000 vectors by chance
NOTABLE = 0.05  # of the slow-roll vector
PEAK = 10.0  # sigma: the largest of rows that are noise is below that
PEAK_INSIDE = 0.98  # of the highest speed: a 1X that is largest at the end of a sweep has no peak in it


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """1X of all rows with the trial masses of the slow roll."""

    index: int  # of 1X among the orders
    probes: tuple[str, ...]
    omega: NDArray[np.float64]  # (row,) rad/s
    z: NDArray[np.complex128]  # (row, probe) m
    sigma: NDArray[np.float64]  # (row, probe) m, of re or im
    usable: NDArray[np.bool_]  # (row, probe)
    chosen: NDArray[np.bool_]  # (row,) the slow roll's

    @classmethod
    def of(cls, response: OrderTrackedResponse, chosen: NDArray[np.bool_]) -> Self | None:
        """Return it of a response whose slow roll are the rows `chosen` (row,); None if 1X was not tracked."""
        if 1.0 not in response.orders:
            return None
        index = response.orders.index(1.0)
        trial = response.runs[response.run[chosen.argmax()]].trial_unbalance
        alike = np.array([run.trial_unbalance == trial for run in response.runs])[response.run]
        variance = np.diagonal(response.covariance[alike, index], axis1=1, axis2=2)
        z = response.z[alike, :, index]
        return cls(
            index=index,
            probes=response.probes,
            omega=response.omega[alike],
            z=z,
            sigma=np.sqrt((variance[:, 0::2] + variance[:, 1::2]) / 2),
            usable=response.usable[alike] & np.isfinite(z),
            chosen=chosen[alike],
        )


def validity_remarks(first: FirstOrder, slow: SlowRoll) -> tuple[str, ...]:
    """Return what speaks against a slow roll, a sentence each; empty if nothing."""
    vector = slow.z[:, first.index]
    if not np.isfinite(vector).any():
        return ()
    peak, largest, where = _largest(first, vector)
    remarks = []
    if np.isfinite(peak) and slow.omega > SLOW * peak:
        remarks.append(
            f"{slow.omega * RPM:.0f} rpm are {slow.omega / peak:.2f} of the {peak * RPM:.0f} rpm at "
            f"which 1X is largest ({_um(largest)} at {first.probes[where]}), want less than {SLOW:g}"
        )
    remarks += _changes_within(first, vector, peak)
    remarks += _dynamic_parts(first, vector, peak, slow.omega)
    return tuple(remarks)


def _largest(first: FirstOrder, vector: NDArray[np.complex128]) -> tuple[float, float, int]:
    """Return speed [rad/s], amplitude [m] and probe of the largest compensated 1X; speed inf where it is no peak."""
    amplitude = np.nan_to_num(np.where(first.usable, np.abs(first.z - vector), 0.0))
    row, probe = np.unravel_index(amplitude.argmax(), amplitude.shape)
    speed = float(first.omega[row])
    inside = speed < PEAK_INSIDE * first.omega.max()
    significant = amplitude[row, probe] > PEAK * first.sigma[row, probe]
    return speed if inside and significant else np.inf, float(amplitude[row, probe]), int(probe)


def dynamic_part(first: FirstOrder, *, probe: int, omega: float, peak: float) -> tuple[float, float]:
    """Return the part of a probe's 1X at a low speed `omega` [rad/s] that is response, and its sigma [m].

    By the rows below half the speed `peak` of the largest 1X, or below four times `omega` where there is none (inf).
    Sigma is zero where they are too few, or not far enough apart, to tell.
    """
    top = LOW * peak if np.isfinite(peak) else LOW_MULTIPLE * omega
    if omega >= top:
        return 0.0, 0.0
    slope, sigma = _slope(first, first.usable[:, probe] & (first.omega <= top), probe, peak)
    return slope * _growth(omega, peak), sigma * _growth(omega, peak)


def _changes_within(first: FirstOrder, vector: NDArray[np.complex128], peak: float) -> list[str]:
    """Return the remark on how much the vector changes over the speeds of the slow roll itself."""
    changes: list[tuple[float, str]] = []
    for p, name in enumerate(first.probes):
        rows = first.chosen & first.usable[:, p] & (first.omega <= LOW * peak)
        slope, sigma = _slope(first, rows, p, peak)
        if sigma:
            low, high = float(first.omega[rows].min()), float(first.omega[rows].max())
            span = _growth(high, peak) - _growth(low, peak)
            if _is_notable(slope * span, sigma * span, vector[p]):
                words = (
                    f"1X at {name} changes by {_um(slope * span)} from {low * RPM:.0f} to {high * RPM:.0f} rpm within "
                    f"the slow roll, {slope / sigma:.0f} times its uncertainty"
                )
                changes.append((slope * span, words))
    return [max(changes)[1]] if changes else []


def _dynamic_parts(first: FirstOrder, vector: NDArray[np.complex128], peak: float, omega: float) -> list[str]:
    """Return the remark on the part of the vector at the slow roll's speed `omega` that is response."""
    parts: list[tuple[float, str]] = []
    for p, name in enumerate(first.probes):
        part, sigma = dynamic_part(first, probe=p, omega=omega, peak=peak)
        if _is_notable(part, sigma, vector[p]):
            words = (
                f"at {omega * RPM:.0f} rpm about {_um(part)} of {_um(abs(vector[p]))} at {name} (1 sigma {_um(sigma)}) "
                "is response to unbalance, not run-out: it grows with the square of speed"
            )
            parts.append((part, words))
    return [max(parts)[1]] if parts else []


def _slope(first: FirstOrder, rows: NDArray[np.bool_], probe: int, peak: float) -> tuple[float, float]:
    """Return |b| [m s^2] and its sigma of z = a + b growth(omega) over `rows`; sigma 0 where they cannot tell.

    Weighted least squares; where the rows scatter more than their noise, sigma is enlarged by that ratio.
    """
    omega = first.omega[rows]
    if len(omega) < FEWEST or omega.max() < APART * omega.min():
        return 0.0, 0.0
    weight = 1 / np.maximum(first.sigma[rows, probe], np.finfo(float).tiny)
    growth = _growths(omega, peak)
    scale = growth.max()
    basis = np.stack([weight, weight * growth / scale], axis=1)
    inverse = np.linalg.pinv(basis)
    measured = weight * first.z[rows, probe]
    fitted = inverse @ measured
    scatter = np.sqrt(np.sum(np.abs(measured - basis @ fitted) ** 2) / (2 * (len(omega) - 2)))
    sigma = np.sqrt((inverse[1] ** 2).sum()) * max(1.0, float(scatter))
    return float(abs(fitted[1]) / scale), float(sigma / scale)


def _growth(omega: float, peak: float) -> float:
    return float(_growths(np.array([omega]), peak)[0])


def _growths(omega: NDArray[np.float64], peak: float) -> NDArray[np.float64]:
    """Return how the response to unbalance grows well below its largest, (row,) rad^2/s^2."""
    return omega**2 / (1 - (omega / peak) ** 2)


def _is_notable(part: float, sigma: float, vector: np.complex128) -> bool:
    """Return True if a part of the slow-roll vector is certain and large enough for a remark."""
    return bool(sigma > 0 and part > SIGNIFICANT * sigma and part > NOTABLE * abs(vector))


def _um(metres: float) -> str:
    return f"{micrometres(metres)} um"
