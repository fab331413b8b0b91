"""Critical speeds of a response, per probe and run: measured, and those of a model's curve beside them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rotorrig.app.plot_data.curves import model_vectors, slow_roll_known, sweeps, vectors
from rotorrig.app.plot_data.diagnosis_of_response import Vectors
from rotorrig.identify import ModelResonance
from rotorrig.processing import OrderTrackedResponse, Resonance, find_resonances

SAME = 0.05  # of the speed: within it a peak of the model is the measured one's


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalSpeed:
    """A resonance in one run of one probe."""

    probe: str
    run: str
    direction: int  # +1 speed rises, -1 falls
    measured: Resonance
    model: Resonance | None  # of the model's curve; None without a model, or where it has no such peak


def critical_speeds(
    response: OrderTrackedResponse, prediction: Vectors | None = None, modelled: Sequence[ModelResonance] = ()
) -> tuple[CriticalSpeed, ...]:
    """Return the resonances of every probe and run, slow-roll compensated where that is known.

    `modelled` are those of a model with their sigmas, as in a file of its fit. Without any they are read, without
    sigmas, off its `prediction` (speed, probe) [m], as `Fit.prediction`.
    """
    return tuple(
        each
        for probe in range(len(response.probes))
        for run in sweeps(response)
        for each in _of_run(response, probe, run, prediction, modelled)
    )


def _of_run(
    response: OrderTrackedResponse,
    probe: int,
    run: int,
    prediction: Vectors | None,
    modelled: Sequence[ModelResonance],
) -> tuple[CriticalSpeed, ...]:
    rows, order = response.run == run, response.orders.index(1.0)
    usable, parts = rows & response.usable[:, probe], slice(2 * probe, 2 * probe + 2)
    slow_roll = response.slow_roll_covariance[order, parts, parts] if slow_roll_known(response) else None
    rate = response.rate(run)
    measured = find_resonances(
        response.omega[usable],
        vectors(response)[usable, probe],
        response.covariance[usable, order, parts, parts],
        common=slow_roll if slow_roll is not None and np.isfinite(slow_roll).all() else None,
        rate=rate,
    )
    here = (response.probes[probe], response.runs[run].name)
    peaks = tuple(each.resonance for each in modelled if (each.probe, each.run) == here)
    if not modelled and prediction is not None:
        peaks = find_resonances(response.omega[rows], model_vectors(response, prediction)[rows, probe], rate=rate)
    return tuple(
        CriticalSpeed(
            probe=response.probes[probe],
            run=response.runs[run].name,
            direction=response.runs[run].direction,
            measured=each,
            model=_nearest(each, peaks),
        )
        for each in measured
    )


def _nearest(measured: Resonance, peaks: tuple[Resonance, ...]) -> Resonance | None:
    """Return the model's peak that is the measured one; None if none is near."""
    speed = measured.omega.value
    nearest = min(peaks, key=lambda peak: abs(peak.omega.value - speed), default=None)
    return nearest if nearest and abs(nearest.omega.value - speed) < SAME * speed else None
