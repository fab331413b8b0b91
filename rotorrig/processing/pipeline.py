"""Tracking pipeline: a recording to order vectors with covariance, mask and slow roll, step by step."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition import WaveformSource
from rotorrig.processing.noise import covariance as noise
from rotorrig.processing.noise import line_remarks
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.rows import Rows, Span, find_runs, lay_rows, quality
from rotorrig.processing.settings import USUAL, Tracking
from rotorrig.processing.shaft_angle import TURN, ShaftAngle, read_keyphasor
from rotorrig.processing.slow_roll import add_slow_roll
from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.processing.tracking import METHODS, TrackingMethod
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig import DataError, code_version
from rotorrig.rig.config import NO_TRIAL, TrialMass, read_trial_mass, trial_unbalance

# shares of the time: done after the rows, taken by the vectors, done after the covariance
_ROWS_DONE, _VECTORS_SHARE, _COVARIANCE_DONE = 0.2, 0.4, 0.9
BEYOND = "the window reaches beyond the samples"


def track(
    recording: WaveformSource,
    settings: Tracking = USUAL,
    *,
    trial: Sequence[TrialMass] | None = None,
    progress: Callable[[float], None] | None = None,
) -> OrderTrackedResponse:
    """Return the order vectors of a recording, rows and method as `settings` say, with their covariance.

    `trial` are the trial masses that were on the rotor all the time, None: those the recording notes. `progress` is
    called with the fraction done. Raises DataError if the recording has no keyphasor pulses, no run or no whole row.
    """
    tell = progress or (lambda done: None)
    waveforms = Waveforms(recording)
    method, orders = METHODS[settings.method], settings.orders
    shaft = read_keyphasor(waveforms)
    masses = trial_mass_history(recording) if trial is None else [(0.0, trial_unbalance(trial))]
    spans = find_runs(recording.events, shaft, trial=masses)
    rows = _rows(shaft, spans, settings)
    _check_rows(rows, spans, waveforms.where)
    tell(_ROWS_DONE)
    z = method.track(
        waveforms, shaft, rows, orders=orders, progress=lambda done: tell(_ROWS_DONE + _VECTORS_SHARE * done)
    )
    spectrum = noise_between_orders(waveforms, shaft, rows, orders=orders)
    covariance = estimate_covariance(spectrum, shaft, rows, z, orders=orders, method=method)
    tell(_COVARIANCE_DONE)
    usable, reasons = quality.assess(waveforms, shaft, rows, spans=spans, probes=recording.rig.probes)
    usable, reasons = mask_rows_without_vectors(z, usable, reasons)
    beyond, unknown = quality.aliased_orders(rows, orders, rate=waveforms.rate)
    raw = _assemble_response(
        recording,
        settings,
        shaft,
        spans,
        rows,
        z=np.where(beyond[:, None], np.nan, z),
        covariance=covariance,
        usable=usable,
        reasons=reasons,
        mains=spectrum.mains,
    )
    hum = line_remarks(spectrum.lines, raw, rows)
    remarks = quality.join_remarks(quality.keyphasor_remarks(shaft, rows), unknown, hum)
    response = add_slow_roll(replace(raw, remarks=remarks), waveforms, shaft, rows, window=settings.slow_roll)
    tell(1.0)
    return response


def _assemble_response(
    recording: WaveformSource,
    settings: Tracking,
    shaft: ShaftAngle,
    spans: tuple[Span, ...],
    rows: Rows,
    **arrays: Any,
) -> OrderTrackedResponse:
    """Assemble the response from its `arrays` per row, before a slow roll is looked for."""
    method = METHODS[settings.method]
    none = slow_roll.none(probes=len(recording.rig.probes), orders=len(settings.orders))
    return OrderTrackedResponse(
        rig=recording.rig,
        probes=tuple(probe.name for probe in recording.rig.probes),
        orders=settings.orders,
        runs=tuple(span.run for span in spans),
        run=rows.run,
        t=rows.t,
        omega=rows.omega,
        alpha=rows.alpha,
        revolutions=np.full(len(rows.t), method.revolutions(float(settings.turns))),
        window=method.window,
        method=settings.method,
        slow_roll=none.z,
        slow_roll_covariance=none.covariance,
        slow_roll_omega=none.omega,
        keyphasor_t=shaft.pulses(),
        omega_sigma=shaft.omega_sigma(rows.t),
        alpha_sigma=shaft.alpha_sigma(rows.t),
        jitter=shaft.jitter(rows.middle, first=int(shaft.turn[0]), last=int(shaft.turn[-1])),
        source=replace(recording.source, config_hash=recording.rig.hash, code_version=code_version()),
        **arrays,
    )


def trial_mass_history(recording: WaveformSource) -> list[tuple[float, dict[str, complex]]]:
    """Return the trial unbalance [kg m] per disk over time, each with the time [s] it was mounted, as a sweep noted it.

    Each note adds a mass to those before, until one says that none is on. Raises ConfigError if one cannot be read.
    """
    changes: list[tuple[float, dict[str, complex]]] = []
    masses: list[TrialMass] = []
    for event in recording.events:
        if event.kind == "trial":
            masses = (
                []
                if event.text == NO_TRIAL
                else [*masses, read_trial_mass(event.text, planes=recording.rig.unbalance_planes)]
            )
            changes.append((event.t_ns / 1e9, trial_unbalance(masses)))
    return changes


def noise_between_orders(
    waveforms: Waveforms, shaft: ShaftAngle, rows: Rows, *, orders: tuple[float, ...]
) -> noise.NoiseSpectrum:
    """Return the noise between the order lines, as far up as the rows' orders reach."""
    fastest = float(np.max(rows.omega)) / TURN
    widest = 8 / float(np.min(rows.end - rows.begin))  # Hz: beyond, a row's window passes 1e-6 of the power
    top = max(abs(order) for order in orders) * fastest + widest
    return noise.noise_spectrum(waveforms, shaft, orders=orders, up_to=min(top, 0.45 * waveforms.rate))


def estimate_covariance(
    spectrum: noise.NoiseSpectrum,
    shaft: ShaftAngle,
    rows: Rows,
    z: NDArray[np.complex128],
    *,
    orders: tuple[float, ...],
    method: TrackingMethod,
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2]: noise between the lines, keyphasor jitter and hum."""
    noisy = noise.row_covariance(spectrum, rows, orders=orders, response=method.noise_response)
    noisy += noise.jitter_covariance(z, shaft, rows, orders=orders, bandwidth=method.bandwidth)
    return noisy + noise.hum_covariance(spectrum, rows, orders=orders, window=method.window)


def mask_rows_without_vectors(
    z: NDArray[np.complex128], usable: NDArray[np.bool_], reasons: quality.Reasons
) -> tuple[NDArray[np.bool_], quality.Reasons]:
    """Mask rows that have no vectors, since their window reaches beyond the data; return the mask and its reasons."""
    missing = np.asarray(usable & np.isnan(z).all(axis=2))
    reasons = tuple((*row, BEYOND) if out.any() else row for row, out in zip(reasons, missing, strict=True))
    return usable & ~missing, reasons


def _rows(shaft: ShaftAngle, spans: tuple[Span, ...], settings: Tracking) -> Rows:
    """Return the rows; in a dwell, where there are no steps of speed, they stand one after another."""
    by_speed = settings.every is not None and settings.every.of == "speed"
    every = [None if by_speed and span.run.direction == 0 else settings.every for span in spans]
    return lay_rows(shaft, [(span.begin, span.end) for span in spans], turns=settings.turns, every=every)


def _check_rows(rows: Rows, spans: tuple[Span, ...], where: str) -> None:
    if not spans:
        raise DataError(
            f'{where}: has no run, want marks "slow roll", "up" or "down", or no mark and a speed that rises or falls'
        )
    if len(rows.t) == 0:
        raise DataError(f"{where}: no run is as long as one row of {rows.turns} turns; want longer runs or fewer turns")
