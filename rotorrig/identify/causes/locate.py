"""Grid search for the location of an effect: a coarse grid over its range, then finer ones about the best.

The moment at which something broke is one: a fit sees no further than a few rows beside where it stands, but what is
left of the misfit falls steadily towards the true moment from far off.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rotorrig.identify.causes.settings import SELECTION
from rotorrig.sims.effects import Effect

Promise = Callable[[Sequence[Effect]], Sequence[float]]  # by how much chi2 would fall, for each


def best_place(effect: Effect, promise: Promise) -> Effect:
    """Return the effect at the location that promises most, with the standard deviation of that as its spread.

    The spread is half the width over which chi2 is within 1 of the best; 0 where a stretch is but one place.
    """
    places = [(stretch, value) for stretch in effect.grid for value in stretch]
    coarse = promise([_at(effect, value) for _, value in places])
    stretch, best = places[int(np.argmax(coarse))]
    known = {value: lam for (of, value), lam in zip(places, coarse, strict=True) if of is stretch}
    for _ in range(SELECTION.looks):
        values = sorted(known)
        i = values.index(best)
        low, high = values[max(i - 1, 0)], values[min(i + 1, len(values) - 1)]
        if known[best] - min(known[low], known[high]) < SELECTION.alike:
            break
        closer = [*_within(low, best), *_within(best, high)]
        known |= zip(closer, promise([_at(effect, value) for value in closer]), strict=True)
        best = max(known, key=known.__getitem__)
    return _at(effect, best, spread=_spread(known, best))


def _within(low: float, high: float) -> list[float]:
    return [float(value) for value in np.linspace(low, high, SELECTION.parts + 1)[1:-1]] if low < high else []


def _at(effect: Effect, value: float, *, spread: float = 0.0) -> Effect:
    moved = (replace(p, at_zero=value, spread=spread) if p.grid_searched else p for p in effect.parameters)
    return replace(effect, parameters=tuple(moved))


def _spread(known: dict[float, float], best: float) -> float:
    """Return half the width over which `known`, value -> lam, is within `SELECTION.one_sigma` of the best."""
    values = np.array(sorted(known))
    drop = known[best] - np.array([known[value] for value in values])
    at = int(np.searchsorted(values, best))
    left, right = (_crossing(values[part], drop[part]) for part in (slice(at, None, -1), slice(at, None)))
    return (right - left) / 2


def _crossing(values: np.ndarray, drop: np.ndarray) -> float:
    """Return where `drop`, from 0 on, first reaches one sigma, by parabolas between neighbours; the end if it never."""
    beyond = np.flatnonzero(drop >= SELECTION.one_sigma)
    if not len(beyond):
        return float(values[-1])
    i = int(beyond[0])
    root = np.sqrt(np.maximum(drop[i - 1 : i + 1], 0.0))
    return float(values[i - 1] + (values[i] - values[i - 1]) * (1 - root[0]) / (root[1] - root[0]))
