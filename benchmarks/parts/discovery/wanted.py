"""The cases of the benchmark of discoveries: those of the blind test, and faults that no effect models beside them."""

import heapq
from collections.abc import Collection

from benchmarks.parts.blind.cases import OUTSIDERS, Case, Extent, cases, modelled, shuffle
from rotorrig.sims.plant.faults.base import fault_names

MOST_LATER = 8  # cases of each fault that no blind test hides


def wanted_cases(*, seeds: int, first: int, hidden: Collection[str] = ()) -> list[Case]:
    """Return the cases of so many seeds from `first` on, in a random order; of what is `hidden` alone if any are given.

    The blind test's keep the order they have without the others, which are spread evenly among them: as far as a run
    has come, both are fair samples.
    """
    extent = Extent(seeds=seeds, healthy=10 * seeds, outsiders=4 * seeds)
    blind = shuffle(list(cases("P2", extent, hidden=hidden, first=first)), attempt=1)
    names = [name for name in later_outsiders() if not hidden or name in hidden]
    later = [Case(design="P2", faults=(name,), seed=first + i) for name in names for i in range(min(seeds, MOST_LATER))]
    both = (
        [((i + 0.5) / len(part), case) for i, case in enumerate(part)] for part in (blind, shuffle(later, attempt=1))
    )
    return [case for _, case in heapq.merge(*both, key=lambda placed: placed[0])]


def later_outsiders() -> tuple[str, ...]:
    """Return the names of the faults that no effect models and no blind test hides."""
    return tuple(name for name in fault_names() if name not in {*modelled(), *OUTSIDERS})
