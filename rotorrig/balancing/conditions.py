"""Conditions of a rotor, with and without trial masses, brought onto common speeds.

A condition is one mounting: all runs of one response with the same trial masses. Runs up, down and at constant speeds
are kept apart, since a moving speed shifts the resonance one way or the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

SAME_SPEED = 0.01  # relative: dwells nearer than this are at one speed; further, influence coefficients are others
WIDEST_GAP = 0.05  # relative: over a wider gap between rows nothing is interpolated
MOST_ROWS = 240  # per direction: evenly thinned, a row more says nothing new of a smooth curve


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """Vibration of several conditions on common speeds, less the slow-roll vector where there is one."""

    probes: tuple[str, ...]
    planes: tuple[str, ...]  # that carry a trial unbalance in any condition
    names: tuple[str, ...]  # (condition,)
    trial: Complex  # (condition, plane) kg m, angle from the keyphasor mark in the sense of rotation
    omega: Reals  # (row,) rad/s
    direction: NDArray[np.intp]  # (row,) +1 speed rises, -1 falls, 0 dwell
    z: Complex  # (condition, row, probe) m, 0-peak; NaN: not measured
    variance: Reals  # (condition, row, probe) m^2, of re and im together: the noise of the rows
    compensated: bool  # False: no slow roll, so runout is in z


@dataclass(frozen=True, slots=True)
class _Curve:
    """Rows of one condition in one direction, by rising speed."""

    omega: Reals  # (row,)
    z: Complex  # (row, probe)
    variance: Reals  # (row, probe)


def gather_conditions(
    responses: Sequence[OrderTrackedResponse], *, bands: Sequence[tuple[float, float]] = ()
) -> Conditions:
    """Bring the runs of some responses onto the speeds of the first condition, within `bands` [rad/s] if given.

    Raises DataError if they are not of one rig turning one way, or have no speeds in common.
    """
    first = responses[0]
    for response in responses[1:]:
        if response.probes != first.probes:
            raise DataError(
                f"responses have the probes {list(first.probes)} and {list(response.probes)}, want the same"
            )
        if response.rig.rotation != first.rig.rotation:
            raise DataError("responses are of both senses of rotation, want runs that turn one way")
    runout = _mean_slow_roll(responses)
    found = sorted(
        ((name, trial, curves) for r in responses for name, trial, curves in _split(r, runout)),
        key=lambda condition: bool(condition[1]),  # the rotor as it is comes first: its speeds are used
    )
    planes = tuple(dict.fromkeys(plane for _, trial, _ in found for plane in trial))
    rows = [
        _align([curves.get(way) for _, _, curves in found], way, bands, probes=len(first.probes)) for way in (1, -1, 0)
    ]
    omega, direction = (np.concatenate([row[i] for row in rows]) for i in (0, 1))
    z, variance = (np.concatenate([row[i] for row in rows], axis=1) for i in (2, 3))
    if not len(omega):
        raise DataError(_nothing_in_common([name for name, _, _ in found], bands))
    return Conditions(
        probes=first.probes,
        planes=planes,
        names=tuple(name for name, _, _ in found),
        trial=np.array([[trial.get(plane, 0) for plane in planes] for _, trial, _ in found], complex),
        omega=omega,
        direction=direction.astype(np.intp),
        z=z,
        variance=variance,
        compensated=bool(np.isfinite(runout).all()),
    )


def vectors_at(
    response: OrderTrackedResponse, omega: Reals, direction: NDArray[np.intp], probe: NDArray[np.intp]
) -> Complex:
    """Return the vibration of a single run at speeds, directions and probes (entry,), m; NaN where it has none.

    Less its own slow-roll vector. Raises DataError if it holds runs with different trial masses.
    """
    found = _split(response, _mean_slow_roll([response]))
    if len(found) != 1:
        raise DataError(f"the run after balancing holds {len(found)} conditions, want one sweep with the masses on")
    curves = found[0][2]
    z = np.full(len(omega), np.nan + 0j)
    for way, curve in curves.items():
        entries = np.flatnonzero(direction == way)
        at = _at_dwells(curve, omega[entries]) if way == 0 else _interpolate(curve, omega[entries])
        z[entries] = at[0][np.arange(len(entries)), probe[entries]]
    return z


def _nothing_in_common(names: Sequence[str], bands: Sequence[tuple[float, float]]) -> str:
    within = "".join(f" {low * RPM:.0f} to {high * RPM:.0f} rpm" for low, high in bands)
    return (
        f"the runs {', '.join(dict.fromkeys(names))} have no speed in common{' within' if within else ''}{within}, "
        f"want the same sweep or dwells in each"
    )


def _mean_slow_roll(responses: Sequence[OrderTrackedResponse]) -> Complex:
    """Return the slow-roll vector per probe, (probe,) m; NaN without one, 0 where a table was compensated already.

    One for all conditions: differences between them are not to take on its noise.
    """
    vectors = []
    for response in responses:
        vector = response.slow_roll[:, response.orders.index(1.0)]
        vectors.append(np.zeros_like(vector) if np.isfinite(response.compensation_omega) else vector)
    known = [vector for vector in vectors if np.isfinite(vector).all()]
    return np.mean(known, axis=0) if known else np.full(len(responses[0].probes), np.nan + 0j)


def _split(response: OrderTrackedResponse, runout: Complex) -> list[tuple[str, dict[str, complex], dict[int, _Curve]]]:
    """Return name, trial unbalance and curves, direction -> curve, of the conditions of a response."""
    n = response.orders.index(1.0)
    z = np.where(response.usable, response.z[:, :, n] - np.nan_to_num(runout), np.nan)
    noise = np.diagonal(response.covariance[:, n], axis1=1, axis2=2)
    variance = noise[:, 0::2] + noise[:, 1::2]
    groups: dict[tuple[tuple[str, complex], ...], list[int]] = {}
    for i, run in enumerate(response.runs):
        if run.name != SLOW_ROLL:
            groups.setdefault(_key(run.trial_unbalance), []).append(i)
    found = []
    for trial, runs in groups.items():
        curves = {}
        for way in {response.runs[i].direction for i in runs}:
            rows = np.flatnonzero(np.isin(response.run, [i for i in runs if response.runs[i].direction == way]))
            rows = rows[np.argsort(response.omega[rows], kind="stable")]
            curves[way] = _Curve(response.omega[rows], z[rows], variance[rows])
        found.append((response.runs[runs[0]].name, dict(trial), curves))
    return found


def _key(trial: dict[str, complex]) -> tuple[tuple[str, complex], ...]:
    return tuple(sorted((plane, complex(u)) for plane, u in trial.items() if u))


def _align(
    curves: Sequence[_Curve | None], way: int, bands: Sequence[tuple[float, float]], *, probes: int
) -> tuple[Reals, Reals, Complex, Reals]:
    """Return speeds and directions (row,), vectors and their variance (condition, row, probe), of one direction."""
    given = [curve for curve in curves if curve is not None]
    if len(given) < len(curves) or not given:
        empty = np.zeros((len(curves), 0, probes))
        return np.zeros(0), np.zeros(0), empty.astype(complex), empty
    omega = _reference_speeds(given[0], way)
    if bands:
        omega = omega[np.any([(omega >= low) & (omega <= high) for low, high in bands], axis=0)]
    at = [_at_dwells(curve, omega) if way == 0 else _interpolate(curve, omega) for curve in given]
    z, variance = np.array([z for z, _ in at]), np.array([v for _, v in at])
    kept = np.isfinite(z).all(axis=0).any(axis=-1)
    return omega[kept], np.full(kept.sum(), float(way)), z[:, kept], variance[:, kept]


def _reference_speeds(curve: _Curve, way: int) -> Reals:
    if way:
        count = min(len(curve.omega), MOST_ROWS)
        return curve.omega[np.unique(np.linspace(0, len(curve.omega) - 1, count).round().astype(int))]
    groups: list[list[float]] = []
    for omega in curve.omega:
        if groups and omega <= groups[-1][0] * (1 + SAME_SPEED):
            groups[-1].append(float(omega))
        else:
            groups.append([float(omega)])
    return np.array([np.mean(group) for group in groups])


def _at_dwells(curve: _Curve, omega: Reals) -> tuple[Complex, Reals]:
    """Return the means of the rows at each speed, and the variance of a mean."""
    near = np.abs(curve.omega[None, :] - omega[:, None]) <= SAME_SPEED * omega[:, None]
    used = near[:, :, None] & np.isfinite(curve.z)[None]
    count = used.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = np.where(used, curve.z[None], 0).sum(axis=1) / count
        variance = np.where(used, curve.variance[None], 0).sum(axis=1) / count**2
    return np.where(count > 0, z, np.nan), variance


def _interpolate(curve: _Curve, omega: Reals) -> tuple[Complex, Reals]:
    """Return vectors between the neighbouring usable rows of each speed; NaN outside them and over wide gaps."""
    shape = (len(omega), curve.z.shape[1])
    z, variance = np.full(shape, np.nan + 0j), np.full(shape, np.nan)
    for probe in range(shape[1]):
        used = np.flatnonzero(np.isfinite(curve.z[:, probe]))
        if not len(used):
            continue
        speeds = curve.omega[used]
        above = np.clip(np.searchsorted(speeds, omega), 0, len(used) - 1)
        below = np.where(speeds[above] == omega, above, above - 1)
        gap = speeds[above] - speeds[below]
        fine = (below >= 0) & (omega <= speeds[above]) & (gap <= WIDEST_GAP * omega)
        share = np.where(gap > 0, (omega - speeds[below]) / np.where(gap > 0, gap, 1), 1.0)
        low, high = used[below], used[above]
        between = (1 - share) * curve.z[low, probe] + share * curve.z[high, probe]
        noise = (1 - share) ** 2 * curve.variance[low, probe] + share**2 * curve.variance[high, probe]
        z[:, probe], variance[:, probe] = np.where(fine, between, np.nan), np.where(fine, noise, np.nan)
    return z, variance
