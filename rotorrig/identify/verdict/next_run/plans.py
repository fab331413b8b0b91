"""Runs one could make next, on a rig with a recording of it."""

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM, RigConfig, TrialMassRuns
from rotorrig.sims.rotor.swept import TURN


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
    dwells: tuple[float, ...] = ()  # rad/s, held one after the other instead of a sweep; rising
    sweeps: int = 1  # that are made
    hands: float = 0.0  # s, of mounting things

    @property
    def seconds(self) -> float:
        """How long it takes, about: at the rig, and of hands."""
        if self.dwells:
            return self.high / self.ramp + len(self.dwells) * (VERDICT.settle + VERDICT.dwell) + self.hands
        return self.sweeps * 2 * self.high / self.ramp + self.hands


def plans(
    response: OrderTrackedResponse,
    *,
    with_trial: bool | None = None,
    unbalance: complex = 0j,
    dwells: Sequence[float] = (),
) -> Iterator[Plan]:
    """Yield what one could do next: what takes no tools, then a trial mass, then more probes.

    Of what takes none, turning the other way comes last: not every drive can, and screws may work loose. `with_trial`
    says whether a trial mass was on in any recording there is; None: see the runs of this one. `unbalance` [kg m] is
    what was found on the first plane: a mass against it tells as much as another, and calms the rotor. `dwells` are
    speeds worth holding [rad/s].
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
    if dwells:
        speeds = tuple(sorted(dwells))
        listed = ", ".join(f"{speed * RPM:.0f}" for speed in speeds)
        words = f"Hold {listed} rpm for {VERDICT.dwell:.0f} s each."
        yield again(kind="dwells", words=words, dwells=speeds, high=speeds[-1])
    words = "Sweep once more with the rotor turning the other way, if the drive can reverse."
    yield again(kind="reverse rotation", words=words, backward=True, hands=VERDICT.rewiring)
    disk = rig.identify.unbalance[0] if rig.identify else rig.disks[0].name
    trial = {disk: VERDICT.trial * 1j}
    against = _against(unbalance)
    if with_trial is None:
        with_trial = any(run.trial_unbalance for run in response.runs)
    if not with_trial:
        words = f"Repeat the sweep with a known trial mass of {VERDICT.trial * 1e6:.0f} g mm at 90 deg on '{disk}'."
        mounted = partial(again, kind="trial mass", hands=VERDICT.mounting)
        yield mounted(words=words, trial=trial)
        if against:
            degrees = math.degrees(cmath.phase(against)) % 360.0
            words = f"Repeat the sweep with a known trial mass of {abs(against) * 1e6:.2g} g mm at {degrees:.0f} deg on"
            yield mounted(words=f"{words} '{disk}', against the unbalance.", trial={disk: against})
    if more := _with_second_plane(rig, read):
        fitted, probes, words = more
        second = partial(again, kind="second plane", rig=fitted, probes=probes)
        yield second(words=f"{words}.", hands=VERDICT.fitting)
        words = f"{words}, and once more with a known trial mass."
        yield second(words=words, trial=trial, sweeps=2, hands=VERDICT.fitting + VERDICT.mounting)


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
