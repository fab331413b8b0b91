"""Planned runs: their rows and noise, from those of a run that was made."""

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model import MarkEdge, Recording
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing import OrderTrackedResponse, Run
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM, RigConfig, TrialMassRuns
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.swept import TURN, Timeline

Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A run one could make."""

    kind: str
    words: str
    rig: RigConfig
    probes: tuple[str, ...]  # that read in it
    low: float  # rad/s
    high: float
    ramp: float  # rad/s^2, up and down
    turns: float  # of a row
    every: int  # turns from row to row
    assumed: str  # a sentence on what the recording at hand does not say and the plan supposes; empty: nothing
    trial: dict[str, complex] = field(default_factory=dict)  # kg m, on the rotor
    backward: bool = False  # the rotor turns the other way


def plans(response: OrderTrackedResponse, *, with_trial: bool | None = None, unbalance: complex = 0j) -> Iterator[Plan]:
    """Yield what one could do next: what takes no tools, then a trial mass, then more probes; the shortest first.

    Of what takes none, turning the other way comes last: not every drive can, and screws may work loose. `with_trial`
    says whether a trial mass was on in any recording there is; None: see the runs of this one. `unbalance` [kg m] is
    what was found on the first plane: a mass against it tells as much as another, and calms the rotor.
    """
    rig, manner = response.rig, _manner(response)
    low, high = _range(response)
    read = response.read
    again = partial(
        Plan,
        rig=rig,
        probes=read,
        low=low,
        high=high,
        ramp=manner.ramp,
        turns=manner.turns,
        every=manner.every,
        assumed=manner.assumed,
    )
    for factor, word in ((3.0, "faster"), (1 / 3, "slower")):
        words = f"Repeat the sweep {word}, at {factor * manner.ramp * RPM:.0f} rpm/s."
        yield again(kind="ramp rate", words=words, ramp=factor * manner.ramp)
    for top in higher_tops(rig, high):
        words = f"Run up to {top * RPM:.0f} rpm."
        yield again(kind="through critical", words=words, high=top)
    words = "Sweep once more with the rotor turning the other way, if the drive can reverse."
    yield again(kind="reverse rotation", words=words, backward=True)
    disk = rig.identify.unbalance[0] if rig.identify else rig.disks[0].name
    trial = {disk: VERDICT.trial * 1j}
    against = _against(unbalance)
    if with_trial is None:
        with_trial = any(run.trial_unbalance for run in response.runs)
    if not with_trial:
        words = f"Repeat the sweep with a known trial mass of {VERDICT.trial * 1e6:.0f} g mm at 90 deg on '{disk}'."
        yield again(kind="trial mass", words=words, trial=trial)
        if against:
            degrees = math.degrees(cmath.phase(against)) % 360.0
            words = f"Repeat the sweep with a known trial mass of {abs(against) * 1e6:.2g} g mm at {degrees:.0f} deg on"
            yield again(kind="trial mass", words=f"{words} '{disk}', against the unbalance.", trial={disk: against})
    if more := _with_second_plane(rig, read):
        fitted, probes, words = more
        second = partial(again, kind="second plane", rig=fitted, probes=probes)
        yield second(words=f"{words}.")
        yield second(words=f"{words}, and once more with a known trial mass.", trial=trial)


def _against(unbalance: complex) -> complex:
    """Return a mass [kg m] opposite an unbalance that takes away half of it, in figures one can mount.

    >>> mass = _against(15e-6 * cmath.exp(0.6j))
    >>> round(abs(mass) * 1e6, 6), round(math.degrees(cmath.phase(mass)) % 360.0, 6)
    (7.5, 215.0)
    """
    degrees = round((math.degrees(cmath.phase(unbalance)) + 180.0) / 5.0) * 5.0
    return cmath.rect(float(f"{abs(unbalance) / 2:.2g}"), math.radians(degrees))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Manner:
    """How a planned run is made where nothing else is asked for: as the recording at hand, as far as that is known."""

    ramp: float  # rad/s^2
    turns: float  # of a row
    every: int  # turns from row to row
    assumed: str


def _manner(response: OrderTrackedResponse) -> _Manner:
    """Return ramp and turns of a recording; where it does not say, the plan's of the config, and rows as dense."""
    assumed = []
    ramp = ramp_of(response)
    if not math.isfinite(ramp):
        plans_of_rig = response.rig.plans.values()
        ramp = next((plan.ramp for plan in plans_of_rig if not isinstance(plan, TrialMassRuns)), VERDICT.ramp)
        assumed.append(f"a ramp of {ramp * RPM:.3g} rpm/s")
    known = response.revolutions[np.isfinite(response.revolutions)]
    if len(known):
        turns = float(np.median(known))
        every = math.ceil(turns)  # a filter's window need not be of whole turns
    else:
        low, high = _range(response)
        every = max(1, round((high**2 - low**2) / (2 * ramp) / TURN / len(response.omega)))
        turns = min(float(every), VERDICT.turns)
        assumed.append(f"{turns:.0f} turn{'s' * (turns != 1)} to a row")
    if not np.isfinite(response.slow_roll_omega):
        assumed.append("no slow roll")
    words = f"Assumed, as the recording does not say: {', '.join(assumed)}." if assumed else ""
    return _Manner(ramp=ramp, turns=turns, every=every, assumed=words)


def ramp_of(response: OrderTrackedResponse) -> float:
    """Return how fast the speed was raised [rad/s^2], the median; of a run that only slows down, that; else NaN."""
    moving = response.alpha[np.isfinite(response.alpha) & (response.alpha != 0)]
    rising = moving[moving > 0]
    return float(np.median(rising if len(rising) else -moving)) if len(moving) else math.nan


def _range(response: OrderTrackedResponse) -> tuple[float, float]:
    """Return the lowest and the highest speed of a planned sweep [rad/s]; of a table of one speed, from below it."""
    high = float(response.omega.max())
    return min(float(response.omega.min()), VERDICT.lowest * high), high


def higher_tops(rig: RigConfig, high: float) -> list[float]:
    """Return speeds [rad/s] to run up to, above `high`, which it was: a quarter of the way to the highest, and so on.

    The highest is 95 % of the overspeed limit, or the drive's own; without either there is none.
    """
    ceilings = [rig.motor.max_speed] if rig.motor else []
    ceilings += [VERDICT.of_overspeed * rig.limits.overspeed] if rig.limits else []
    top = min(ceilings, default=high)
    if top < VERDICT.higher * high:
        return []
    return [high + share * (top - high) for share in (0.25, 0.5, 0.75, 1.0)]


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
    pulses = _pulses(plan)
    first = np.arange(0, len(pulses) - plan.every, plan.every)
    timeline = Timeline(pulses)
    t = np.interp(first + plan.every / 2, np.arange(len(pulses)), pulses)
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
        runs=(
            Run(name="up", direction=1, trial_unbalance=trial),
            Run(name="down", direction=-1, trial_unbalance=trial),
        ),
        run=(t > pulses[-1] / 2).astype(np.intp),
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
        keyphasor_t=pulses,
        compensation_omega=math.nan,
        derived_times=False,
        omega_sigma=np.empty(0),
        alpha_sigma=np.empty(0),
        jitter=np.empty(0),
        remarks=(),
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


def _pulses(plan: Plan) -> Reals:
    low, high = max(plan.low, VERDICT.fewest_rpm / RPM), plan.high
    turns = max(1, round((high**2 - low**2) / (2 * plan.ramp) / TURN))  # whole ones, so that the way down is in step
    rate = (high**2 - low**2) / (2 * turns * TURN)
    up = (np.sqrt(low**2 + 2 * rate * TURN * np.arange(turns + 1)) - low) / rate
    return np.concatenate([up, 2 * up[-1] - up[-2::-1]])


def _with_second_plane(rig: RigConfig, read: tuple[str, ...]) -> tuple[RigConfig, tuple[str, ...], str] | None:
    """Return the rig with a second plane of probes, the probes that then read, and what to do; None if it has one.

    That is the plane of the config whose probes did not read, or else one halfway between the first and the bearing
    sought.
    """
    positions = sorted({rig.probe(name).position for name in read})
    if len(positions) > 1:
        return None
    idle = [probe for probe in rig.probes if probe.position != positions[0]]
    if idle:
        probes = tuple(probe.name for probe in rig.probes if probe.name in read or probe in idle)
        return rig, probes, f"Measure in the second plane too, with {' and '.join(probe.name for probe in idle)}"
    sought = rig.bearing(rig.identify.bearings[0][0]).position if rig.identify else rig.shaft.length
    where = (positions[0] + sought) / 2
    more = tuple(rig.probe(name).model_copy(update={"name": f"{name} (2nd plane)", "position": where}) for name in read)
    fitted = rig.model_copy(update={"probes": rig.probes + more})
    return fitted, (*read, *(probe.name for probe in more)), f"Measure in a second plane, say at {where * 1e3:.0f} mm"
