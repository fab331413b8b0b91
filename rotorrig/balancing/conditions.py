"""Conditions of a rotor, with and without trial masses, brought onto common speeds.

A condition is one mounting: all runs of one response with the same trial masses. Runs up, down and at constant speeds
are kept apart, since a moving speed shifts the resonance one way or the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.row_curves import Curve, average_dwells, hum_variance, interpolate, reference_speeds
from rotorrig.identify.measurement import SLOW_ROLL
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]


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
        ((name, trial, curves) for r in responses for name, trial, curves in _split(r, _slow_roll_of(r, runout))),
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
    found = _split(response, _slow_roll_of(response))
    if len(found) != 1:
        raise DataError(f"the run after balancing holds {len(found)} conditions, want one sweep with the masses on")
    curves = found[0][2]
    z = np.full(len(omega), np.nan + 0j)
    for way, curve in curves.items():
        entries = np.flatnonzero(direction == way)
        at = average_dwells(curve, omega[entries]) if way == 0 else interpolate(curve, omega[entries])
        z[entries] = at[0][np.arange(len(entries)), probe[entries]]
    return z


def _nothing_in_common(names: Sequence[str], bands: Sequence[tuple[float, float]]) -> str:
    within = "".join(f" {low * RPM:.0f} to {high * RPM:.0f} rpm" for low, high in bands)
    return (
        f"the runs {', '.join(dict.fromkeys(names))} have no speed in common{' within' if within else ''}{within}, "
        f"want the same sweep or dwells in each"
    )


def _mean_slow_roll(responses: Sequence[OrderTrackedResponse]) -> Complex:
    """Return the mean slow-roll vector per probe, (probe,) m; NaN if no response has one."""
    vectors = [_slow_roll_of(response) for response in responses]
    known = [vector for vector in vectors if np.isfinite(vector).all()]
    return np.mean(known, axis=0) if known else np.full(len(responses[0].probes), np.nan + 0j)


def _slow_roll_of(response: OrderTrackedResponse, otherwise: Complex | None = None) -> Complex:
    """Return the slow-roll vector per probe, (probe,) m, or what is told `otherwise`; 0 of a compensated table.

    Each condition has its own: what the masses do at slow roll already is in it, and goes off with it in proportion.
    """
    vector = response.slow_roll[:, response.orders.index(1.0)]
    if np.isfinite(response.compensation_omega):
        return np.zeros_like(vector)
    return vector if otherwise is None or np.isfinite(vector).all() else otherwise


def _split(response: OrderTrackedResponse, runout: Complex) -> list[tuple[str, dict[str, complex], dict[int, Curve]]]:
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
            hum = hum_variance(response, rows, z[rows]) if way else 0.0
            curves[way] = Curve(response.omega[rows], z[rows], variance[rows] + hum)
        found.append((response.runs[runs[0]].name, dict(trial), curves))
    return found


def _key(trial: dict[str, complex]) -> tuple[tuple[str, complex], ...]:
    return tuple(sorted((plane, complex(u)) for plane, u in trial.items() if u))


def _align(
    curves: Sequence[Curve | None], way: int, bands: Sequence[tuple[float, float]], *, probes: int
) -> tuple[Reals, Reals, Complex, Reals]:
    """Return speeds and directions (row,), vectors and their variance (condition, row, probe), of one direction."""
    given = [curve for curve in curves if curve is not None]
    if len(given) < len(curves) or not given:
        empty = np.zeros((len(curves), 0, probes))
        return np.zeros(0), np.zeros(0), empty.astype(complex), empty
    omega = reference_speeds(given[0], way)
    if bands:
        omega = omega[np.any([(omega >= low) & (omega <= high) for low, high in bands], axis=0)]
    at = [average_dwells(curve, omega) if way == 0 else interpolate(curve, omega) for curve in given]
    z, variance = np.array([z for z, _ in at]), np.array([v for _, v in at])
    kept = np.isfinite(z).all(axis=0).any(axis=-1)
    return omega[kept], np.full(kept.sum(), float(way)), z[:, kept], variance[:, kept]
