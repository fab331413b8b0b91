"""Recordings of runs that were not made: their speeds, rows and noise, from those of a run that was."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model import MarkEdge, Recording
from rotorrig.identify.verdict.next_run.plans import Plan
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing import OrderTrackedResponse, Run
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.swept import TURN, Timeline

Reals = NDArray[np.float64]

STEP = 1e-3  # s, in which the angle of a rotor that is held is added up


def plan_recordings(plan: Plan, measured: Sequence[Recording]) -> tuple[list[Recording], tuple[Effect, ...]]:
    """Return the recordings a fit has once a plan is made, and the unknowns that come along; the planned ones last.

    Those that were made come first, unless the plan's probes are others: then one with a trial mass, or of a rotor that
    turns the other way, comes after one without. Planned vectors are nothing yet, their noise is that of the first
    recording at like speeds.
    """
    response = measured[0].response
    made = list(measured) if plan.probes == response.probes else []
    wanted = [(plan.trial, plan.backward)]
    if not made and (plan.trial or plan.backward):
        wanted.insert(0, ({}, False))
    recordings, unknown = list(made), []
    for number, (trial, backward) in enumerate(wanted, start=len(made)):
        planned = _response(response, plan, trial)
        if backward:
            planned = replace(planned, rig=plan.rig.turned_over)
            unknown.append(MarkEdge.of_recording(number))
        recordings.append(Recording(planned, number=number, backward=backward, planned=True))
    return recordings, tuple(unknown)


def _response(response: OrderTrackedResponse, plan: Plan, trial: dict[str, complex]) -> OrderTrackedResponse:
    course = _hold(plan) if plan.dwells else _sweep(plan)
    timeline = Timeline(course.pulses)
    t = np.interp(course.first + plan.every / 2, np.arange(len(course.pulses)), course.pulses)
    omega = timeline.omega(t)
    read = response.read
    source = [read.index(name) if name in read else i % len(read) for i, name in enumerate(plan.probes)]
    places = [response.probes.index(read[i]) for i in source]
    rows, orders = len(t), len(response.orders)
    nothing = np.full((len(plan.probes), orders), 1e-12 + 0j)
    slow = np.isfinite(response.slow_roll_omega) and np.isfinite(response.slow_roll[places]).all()
    return replace(
        response,
        rig=plan.rig,
        probes=plan.probes,
        runs=tuple(Run(name=name, direction=way, trial_unbalance=trial) for name, way in course.runs),
        run=course.run,
        t=t,
        omega=omega,
        alpha=timeline.alpha(t),
        revolutions=np.full(rows, plan.turns),
        z=np.broadcast_to(nothing, (rows, *nothing.shape)).copy(),
        covariance=_of_probes(response.covariance[_like_rows(response, omega)], places, source),
        slow_roll=nothing if slow else np.full_like(nothing, np.nan),
        slow_roll_covariance=_of_probes(response.slow_roll_covariance[None], places, source)[0],
        slow_roll_omega=response.slow_roll_omega if slow else math.nan,
        usable=np.ones((rows, len(plan.probes)), dtype=bool),
        reasons=((),) * rows,
        keyphasor_t=course.pulses,
        compensation_omega=math.nan,
        derived_times=False,
        omega_sigma=np.empty(0),
        alpha_sigma=np.empty(0),
        jitter=np.empty(0),
        remarks=(),
        mains=tuple(replace(hum, shares=hum.shares[places]) if len(hum.shares) else hum for hum in response.mains),
        slow_roll_waveform=np.empty((0, 0)),
    )


def _like_rows(response: OrderTrackedResponse, omega: Reals) -> NDArray[np.intp]:
    """Return the row nearest in speed to each of `omega`, of those in which every probe that reads at all has a value.

    Raises DataError if there is none.
    """
    read = response.usable.any(axis=0)
    whole = np.flatnonzero(response.usable[:, read].all(axis=1))
    if not len(whole):
        raise DataError("no row has a value of every probe, want some to take the noise of a planned run from")
    return whole[np.abs(response.omega[whole, None] - omega).argmin(axis=0)]


def _of_probes(covariance: Reals, places: list[int], source: list[int]) -> Reals:
    """Return covariances (..., 2 probe, 2 probe) of probes like those at `places`; copies are independent.

    `source` numbers the probes that are like the same one alike.
    """
    pairs = np.array([[2 * i, 2 * i + 1] for i in places]).ravel()
    taken = covariance[..., pairs[:, None], pairs]
    same = np.array([[a == b or source[a] != source[b] for b in range(len(source))] for a in range(len(source))])
    new = np.array([source.index(i) != n for n, i in enumerate(source)])
    same &= ~(new[:, None] ^ new[None, :])
    return np.where(np.repeat(np.repeat(same, 2, axis=0), 2, axis=1), taken, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Course:
    """The turns of a planned recording: when each begins, and which rows and runs they are."""

    pulses: Reals  # (turn,) s, of the keyphasor
    first: NDArray[np.intp]  # (row,) its first turn
    run: NDArray[np.intp]  # (row,) number in `runs`
    runs: tuple[tuple[str, int], ...]  # name and direction of each


def _sweep(plan: Plan) -> _Course:
    """Return a run up and one down."""
    low, high = max(plan.low, VERDICT.fewest_rpm / RPM), plan.high
    turns = max(1, round((high**2 - low**2) / (2 * plan.ramp) / TURN))  # whole ones, so that the way down is in step
    rate = (high**2 - low**2) / (2 * turns * TURN)
    up = (np.sqrt(low**2 + 2 * rate * TURN * np.arange(turns + 1)) - low) / rate
    pulses = np.concatenate([up, 2 * up[-1] - up[-2::-1]])
    first = np.arange(0, len(pulses) - plan.every, plan.every)
    middle = np.interp(first + plan.every / 2, np.arange(len(pulses)), pulses)
    run = (middle > pulses[-1] / 2).astype(np.intp)
    return _Course(pulses=pulses, first=first, run=run, runs=(("up", 1), ("down", -1)))


def _hold(plan: Plan) -> _Course:
    """Return runs at one speed after the other, with ramps between them that are in no row."""
    when, omega, held = [0.0], [max(min(plan.low, *plan.dwells), VERDICT.fewest_rpm / RPM)], []
    for speed in plan.dwells:
        begin = when[-1] + max(abs(speed - omega[-1]) / plan.ramp, STEP)
        held.append((begin + VERDICT.settle, begin + VERDICT.settle + VERDICT.dwell))
        when += [begin, held[-1][1]]
        omega += [speed, speed]
    t = np.arange(0.0, when[-1], STEP)
    angle = np.cumsum(np.interp(t, when, omega)) * STEP
    pulses = np.interp(np.arange(1, int(angle[-1] / TURN)) * TURN, angle, t)
    spans = [np.searchsorted(pulses, each) for each in held]
    firsts = [np.arange(begin, end - plan.every, plan.every) for begin, end in spans]
    return _Course(
        pulses=pulses,
        first=np.concatenate(firsts),
        run=np.repeat(np.arange(len(held)), [len(first) for first in firsts]),
        runs=tuple((f"dwell {speed * RPM:.0f} rpm", 0) for speed in plan.dwells),
    )
