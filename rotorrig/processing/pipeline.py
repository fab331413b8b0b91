"""A recording to order vectors, in a few named calls."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing import noise, quality, slow_roll
from rotorrig.processing.orders import Rows, lay_rows, track_orders
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.runs import Span, find_runs
from rotorrig.processing.tacho import TURN, ShaftAngle, find_edges, levels, shaft_angle
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.errors import DataError
from rotorrig.rig.provenance import code_version
from rotorrig.rig.trial_mass import NO_TRIAL, TrialMass, read_trial_mass, trial_unbalance

ORDERS = (0.0, 0.5, 1.0, 2.0, 3.0)  # the gap, half and whole multiples of the speed that faults are known by
HYSTERESIS = 0.25  # of the distance between the keyphasor's levels


def track(
    recording: RawRecording,
    *,
    turns: int = 8,
    orders: tuple[float, ...] = ORDERS,
    trial: Sequence[TrialMass] | None = None,
    progress: Callable[[float], None] | None = None,
) -> OrderTrackedResponse:
    """Return the order vectors of a recording, a row per `turns` turns, with their covariance.

    `trial` are the trial masses that were on the rotor all the time, None: those the recording notes. `progress` is
    told the fraction done. Raises DataError if the recording has no keyphasor pulses, no run or no whole row, or if
    the window is too short to tell the orders apart.
    """
    orders = tuple(float(order) for order in orders)
    waveforms = Waveforms(recording)
    _check_orders(orders, turns, waveforms.where)
    shaft = read_keyphasor(waveforms)
    masses = recorded_trial_masses(recording) if trial is None else [(0.0, trial_unbalance(trial))]
    spans = find_runs(recording.events, shaft, trial=masses)
    rows = lay_rows(shaft, [(span.begin, span.end) for span in spans], turns=turns)
    _check_rows(rows, spans, waveforms.where)
    z = track_orders(waveforms, shaft, rows, orders=orders, progress=progress)
    covariance = estimate_covariance(waveforms, shaft, rows, z, orders=orders)
    usable, reasons = quality.assess(waveforms, shaft, rows, spans=spans, probes=recording.rig.probes)
    slow, usable, reasons = slow_roll_of(spans, rows, z, covariance, usable, reasons)
    return OrderTrackedResponse(
        rig=recording.rig,
        probes=tuple(probe.name for probe in recording.rig.probes),
        orders=orders,
        runs=tuple(span.run for span in spans),
        run=rows.run,
        t=rows.t,
        omega=rows.omega,
        alpha=rows.alpha,
        revolutions=np.full(len(rows.t), float(turns)),
        window="hann",
        z=z,
        covariance=covariance,
        slow_roll=slow.z,
        slow_roll_covariance=slow.covariance,
        slow_roll_omega=slow.omega,
        usable=usable,
        reasons=reasons,
        keyphasor_t=shaft.pulses(),
        source=replace(recording.source, config_hash=recording.rig.hash, code_version=code_version()),
    )


def recorded_trial_masses(recording: RawRecording) -> list[tuple[float, dict[str, complex]]]:
    """Return since when [s] which unbalance [kg m] was on per disk, as a sweep noted it.

    Each note adds a mass to those before, until one says that none is on. Raises ConfigError if one cannot be read.
    """
    changes: list[tuple[float, dict[str, complex]]] = []
    masses: list[TrialMass] = []
    for event in recording.events:
        if event.kind == "trial":
            masses = [] if event.text == NO_TRIAL else [*masses, read_trial_mass(event.text, rig=recording.rig)]
            changes.append((event.t_ns / 1e9, trial_unbalance(masses)))
    return changes


def read_keyphasor(waveforms: Waveforms) -> ShaftAngle:
    """Return the shaft angle by the config's keyphasor; the threshold is midway between the levels unless given.

    Raises DataError if there are no pulses, too few, or too many at the wrong time.
    """
    keyphasor = waveforms.keyphasor
    where = f"{waveforms.where}: keyphasor (channel {keyphasor.channel})"
    stretches = waveforms.keyphasor_volts()
    low, high = levels(np.concatenate([volts for _, volts in stretches]), where=where)
    threshold = (low + high) / 2 if keyphasor.threshold is None else keyphasor.threshold
    if not low < threshold < high:
        raise DataError(
            f"{where}: keyphasor.threshold is {threshold:g} V, want it between the levels of {low:.2f} and {high:.2f} V"
        )
    band = HYSTERESIS * 2 * min(threshold - low, high - threshold)
    edges = [
        find_edges(volts, edge=keyphasor.edge, threshold=threshold, band=band, first_sample=first)
        for first, volts in stretches
    ]
    return shaft_angle(np.concatenate(edges) / waveforms.rate, gaps=waveforms.gaps, where=where)


def estimate_covariance(
    waveforms: Waveforms,
    shaft: ShaftAngle,
    rows: Rows,
    z: NDArray[np.complex128],
    *,
    orders: tuple[float, ...],
) -> NDArray[np.float64]:
    """Return the covariance (row, order, 2 probe, 2 probe) [m^2]: noise between the lines and keyphasor jitter."""
    fastest = float(np.max(rows.omega)) / TURN
    widest = 8 / float(np.min(rows.end - rows.begin))  # Hz: beyond, a row's window passes 1e-6 of the power
    top = max(abs(order) for order in orders) * fastest + widest
    spectrum = noise.noise_spectrum(waveforms, shaft, orders=orders, up_to=min(top, 0.45 * waveforms.rate))
    return noise.row_covariance(spectrum, rows, orders=orders) + noise.jitter_covariance(z, shaft, rows, orders=orders)


def slow_roll_of(
    spans: tuple[Span, ...],
    rows: Rows,
    z: NDArray[np.complex128],
    covariance: NDArray[np.float64],
    usable: NDArray[np.bool_],
    reasons: quality.Reasons,
) -> tuple[slow_roll.SlowRoll, NDArray[np.bool_], quality.Reasons]:
    """Return the slow-roll vector of the run named "slow roll", and the mask with its rows out if it is a doubtful one.

    The vector itself is kept: what speaks against it enlarges its covariance and stands in the rows' reasons.
    """
    index = next((i for i, span in enumerate(spans) if span.run.name == "slow roll"), None)
    mine = rows.run == index
    if index is None or not mine.any():
        return slow_roll.none(probes=z.shape[1], orders=z.shape[2]), usable, reasons
    slow = slow_roll.estimate(z[mine], covariance[mine], rows.omega[mine], usable=usable[mine])
    if slow.remarks:
        usable = usable & ~mine[:, None]
        reasons = tuple((*row, *slow.remarks) if out else row for row, out in zip(reasons, mine, strict=True))
    return slow, usable, reasons


def _check_orders(orders: tuple[float, ...], turns: int, where: str) -> None:
    """Check that the orders do not leak into each other or the whole ones: a Hann window is zero from 2 / turns on."""
    for order in orders:
        apart = min(abs(order - round(order)) or 1.0, 1.0)
        if turns * apart < 2 or (turns * order) % 1:
            raise DataError(
                f"{where}: rows of {turns} turns cannot tell order {order:g} from its neighbours, "
                f"want turns = {math.ceil(2 / apart)} or a multiple of it"
            )


def _check_rows(rows: Rows, spans: tuple[Span, ...], where: str) -> None:
    if not spans:
        raise DataError(
            f'{where}: has no run, want marks "slow roll", "up" or "down", or no mark and a speed that rises or falls'
        )
    if len(rows.t) == 0:
        raise DataError(f"{where}: no run is as long as one row of {rows.turns} turns; want longer runs or fewer turns")
