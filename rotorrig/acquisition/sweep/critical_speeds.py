"""Critical speeds in a sweep: ramps pass them at a minimum rate, and nothing dwells at one."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from rotorrig.acquisition.sweep.steps import Coast, Dwell, Ramp, Rest, Step
from rotorrig.rig.config import RPM, Limits

MARGIN = 0.1  # of a model's critical speed on either side: a nameplate's is good to some per cent, a peak 5 % wide
ROUNDING = 1e-9  # of a speed that was added up from steps


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """Band of speeds around a critical speed [rad/s]."""

    low: float
    high: float

    def __contains__(self, speed: float) -> bool:
        return self.low * (1 - ROUNDING) <= speed <= self.high * (1 + ROUNDING)

    def __str__(self) -> str:
        return f"{self.low * RPM:.0f}-{self.high * RPM:.0f} rpm"


def critical_bands(limits: Limits | None, criticals: Sequence[float] = ()) -> tuple[Band, ...]:
    """Return the config's critical bands, else bands around the critical speeds `criticals` [rad/s] of a model.

    The model's count only where the config names a `critical_ramp`; bands that touch are merged.
    """
    if limits is None:
        return ()
    if limits.critical_bands or limits.critical_ramp is None:
        return tuple(sorted((Band(low=b.low, high=b.high) for b in limits.critical_bands), key=lambda b: b.low))
    bands: list[Band] = []
    for speed in sorted(criticals):
        band = Band(low=speed * (1 - MARGIN), high=speed * (1 + MARGIN))
        if bands and band.low <= bands[-1].high:
            band = Band(low=bands.pop().low, high=band.high)
        bands.append(band)
    return tuple(bands)


def pass_bands_quickly(steps: Iterable[Step], *, bands: Sequence[Band], rate: float | None) -> Iterator[Step]:
    """Yield the steps with every slower ramp split at the edges of the bands, at `rate` [rad/s^2] inside them."""
    for step, start in with_start_speeds(steps):
        if isinstance(step, Ramp) and rate is not None and step.rate < rate:
            yield from _split_ramp(step, start, bands, rate)
        else:
            yield step


def with_start_speeds(steps: Iterable[Step]) -> Iterator[tuple[Step, float]]:
    """Yield each step with the speed at which it begins [rad/s], from rest."""
    speed = 0.0
    for step in steps:
        yield step, speed
        match step:
            case Ramp():
                speed = step.end
            case Coast():
                speed = step.until
            case Rest():
                speed = 0.0


def dwells_in_bands(steps: Iterable[Step], bands: Sequence[Band]) -> Iterator[tuple[Step, float, Band]]:
    """Yield each step that holds a speed inside a band, with that speed [rad/s]: a dwell, or a ramp that ends there."""
    for step, start in with_start_speeds(steps):
        speed = step.to if isinstance(step, Ramp) and step.until is None else start if isinstance(step, Dwell) else 0.0
        for band in bands:
            if speed in band:
                yield step, speed, band


def _split_ramp(step: Ramp, start: float, bands: Sequence[Band], rate: float) -> Iterator[Step]:
    """Yield the pieces of a ramp: each aims at its final speed, and gives way to the next at the edge of a band."""
    low, high = sorted((start, step.end))
    edges = [(b.low, b.high) for b in bands if b.low < high and b.high > low]
    if step.end < start:
        edges = [(b, a) for a, b in reversed(edges)]
    way = 1.0 if step.end > start else -1.0
    for enter, leave in edges:
        if way * (enter - start) > 0:
            yield Ramp(to=step.to, rate=step.rate, until=enter)
        if way * (leave - step.end) >= 0:
            yield Ramp(to=step.to, rate=rate, until=step.until)
            return
        yield Ramp(to=step.to, rate=rate, until=leave)
    yield step
