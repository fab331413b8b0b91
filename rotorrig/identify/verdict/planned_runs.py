"""Planned runs: their rows and noise, from those of a run that was made."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model import MarkEdge, Recording
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing import OrderTrackedResponse, Run
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.swept import TURN, Timeline

Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A run one could make."""

    kind: str
    words: str
    rig: RigConfig
    low: float  # rad/s
    high: float
    ramp: float  # rad/s^2, up and down
    trial: dict[str, complex] = field(default_factory=dict)  # of a second recording; empty: there is none with one
    backward: bool = False  # a second recording has the rotor turning the other way

    @property
    def unknown(self) -> tuple[Effect, ...]:
        """Unknown effects of a fit of these recordings, beside those of the first alone."""
        return (MarkEdge.of_recording(1),) if self.backward else ()


def plans(response: OrderTrackedResponse) -> Iterator[Plan]:
    """Yield what one could do next, cheapest first: what takes no tools, then a trial mass, then more probes.

    Of what takes none, turning the other way comes last: not every drive can, and screws may work loose.
    """
    rig = response.rig
    low, high = float(response.omega.min()), float(response.omega.max())
    ramp = float(np.median(np.abs(response.alpha[np.isfinite(response.alpha)]))) or 3.0
    again = partial(Plan, rig=rig, low=low, high=high, ramp=ramp)
    for factor, word in ((1 / 3, "slower"), (3.0, "faster")):
        words = f"Repeat the sweep {word}, at {factor * ramp * RPM:.0f} rpm/s."
        yield again(kind="ramp rate", words=words, ramp=factor * ramp)
    if (top := _fastest(rig, high)) > 1.05 * high:
        words = f"Run up to {top * RPM:.0f} rpm, as far as the limits allow."
        yield again(kind="through critical", words=words, high=top)
    words = "Sweep once more with the rotor turning the other way, if the drive can reverse."
    yield again(kind="reverse rotation", words=words, backward=True)
    disk = rig.identify.unbalance[0] if rig.identify else rig.disks[0].name
    trial = {disk: VERDICT.trial * 1j}
    if not any(run.trial_unbalance for run in response.runs):
        words = f"Repeat the sweep with a known trial mass of {VERDICT.trial * 1e6:.0f} g mm at 90 deg on '{disk}'."
        yield again(kind="trial mass", words=words, trial=trial)
    if more := _with_second_plane(rig):
        words = f"Measure in a second plane, say at {more.probes[-1].position * 1e3:.0f} mm"
        second = partial(again, kind="second plane", rig=more)
        yield second(words=f"{words}.")
        yield second(words=f"{words}, and once more with a known trial mass.", trial=trial)


def _fastest(rig: RigConfig, high: float) -> float:
    """Return the speed up to which the rig may be run [rad/s]; `high`, which it was, if it has no drive."""
    top = rig.motor.max_speed if rig.motor else high
    if rig.limits is not None and rig.limits.overspeed:
        top = min(top, 0.95 * rig.limits.overspeed)
    return top


def plan_recordings(response: OrderTrackedResponse, plan: Plan) -> list[Recording]:
    """Return the recordings of a plan, their vectors nothing yet, their noise that of `response` at like speeds."""
    first = _response(response, plan, {})
    if plan.backward:
        reverse = replace(first, rig=plan.rig.turned_over)
        return [Recording(first, planned=True), Recording(reverse, number=1, backward=True, planned=True)]
    both = [first, _response(response, plan, plan.trial)] if plan.trial else [first]
    return [Recording(r, number=i, planned=True) for i, r in enumerate(both)]


def _response(response: OrderTrackedResponse, plan: Plan, trial: dict[str, complex]) -> OrderTrackedResponse:
    turns = float(np.median(response.revolutions))
    pulses = _pulses(plan)
    length = math.ceil(turns)  # a filter's window need not be of whole turns
    first = np.arange(0, len(pulses) - length, length)
    timeline = Timeline(pulses)
    t = np.interp(first + length / 2, np.arange(len(pulses)), pulses)
    omega = timeline.omega(t)
    like = np.abs(response.omega[:, None] - omega).argmin(axis=0)
    probes = tuple(probe.name for probe in plan.rig.probes)
    known = response.probes
    source = [known.index(name) if name in known else i % len(known) for i, name in enumerate(probes)]
    rows, orders = len(t), len(response.orders)
    z = np.full((rows, len(probes), orders), 1e-12 + 0j)
    return replace(
        response,
        rig=plan.rig,
        probes=probes,
        runs=(
            Run(name="up", direction=1, trial_unbalance=trial),
            Run(name="down", direction=-1, trial_unbalance=trial),
        ),
        run=(t > pulses[-1] / 2).astype(np.intp),
        t=t,
        omega=omega,
        alpha=timeline.alpha(t),
        revolutions=np.full(rows, turns),
        z=z,
        covariance=_of_probes(response.covariance[like], source),
        slow_roll=z[0],
        slow_roll_covariance=_of_probes(response.slow_roll_covariance[None], source)[0],
        usable=np.ones((rows, len(probes)), dtype=bool),
        reasons=((),) * rows,
        keyphasor_t=pulses,
        omega_sigma=np.empty(0),
        alpha_sigma=np.empty(0),
        jitter=np.empty(0),
        remarks=(),
        slow_roll_waveform=np.empty((0, 0)),
    )


def _of_probes(covariance: Reals, source: list[int]) -> Reals:
    """Return covariances (..., 2 probe, 2 probe) of probes like those of the indices; copies are independent."""
    pairs = np.array([[2 * i, 2 * i + 1] for i in source]).ravel()
    taken = covariance[..., pairs[:, None], pairs]
    same = np.array([[a == b or source[a] != source[b] for b in range(len(source))] for a in range(len(source))])
    new = np.array([source.index(i) != n for n, i in enumerate(source)])
    same &= ~(new[:, None] ^ new[None, :])
    return taken * np.repeat(np.repeat(same, 2, axis=0), 2, axis=1)


def _pulses(plan: Plan) -> Reals:
    low, high = max(plan.low, VERDICT.fewest_rpm / RPM), plan.high
    turns = max(1, round((high**2 - low**2) / (2 * plan.ramp) / TURN))  # whole ones, so that the way down is in step
    rate = (high**2 - low**2) / (2 * turns * TURN)
    up = (np.sqrt(low**2 + 2 * rate * TURN * np.arange(turns + 1)) - low) / rate
    return np.concatenate([up, 2 * up[-1] - up[-2::-1]])


def _with_second_plane(rig: RigConfig) -> RigConfig | None:
    """Return the rig with a second pair of probes halfway between the first and the bearing sought; None if it has."""
    positions = sorted({probe.position for probe in rig.probes})
    if len(positions) > 1:
        return None
    sought = rig.bearing(rig.identify.bearings[0][0]).position if rig.identify else rig.shaft.length
    where = (positions[0] + sought) / 2
    more = tuple(
        probe.model_copy(update={"name": f"{probe.name} (2nd plane)", "position": where}) for probe in rig.probes
    )
    return rig.model_copy(update={"probes": rig.probes + more})
