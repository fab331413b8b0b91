"""Runs for the pictures of chea.md: the chapter's test functions, a colony bred by itself, a search watched."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea import SEED, Profile, Search
from rotorrig.identify.chea.chapter.clustering import Clustering, cluster
from rotorrig.identify.chea.chapter.genetic import Colony
from rotorrig.identify.chea.session import Evaluations, Record

Array = NDArray[np.float64]
T = TypeVar("T")

PEAKS = np.array([[a * 0.43880, b * 0.30585] for a in (1, -1) for b in (1, -1)])  # Table 3
_UNIT = np.array([[0.0, 0.0], [1.0, 1.0]])


@dataclass(frozen=True)
class Function:
    """A test function of section 3 on its box, (n, 2) -> (n,)."""

    name: str
    fun: Callable[[Array], Array]
    half: float

    @property
    def ends(self) -> tuple[float, float]:
        """Both ends of the box, in either parameter."""
        return -self.half, self.half

    def at(self, u: Array) -> Array:
        """Return the values at points (n, 2) of the unit cube."""
        return self.fun(self.place(u))

    def place(self, u: Array) -> Array:
        """Return where points of the unit cube lie in the box."""
        return (2 * np.asarray(u) - 1) * self.half


def _banana(x: Array) -> Array:
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


def _peaks(x: Array) -> Array:
    u, v = np.pi * x.T
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))


def _rastrigin(x: Array) -> Array:
    return 20 + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


BANANA = Function("banana", _banana, 2.0)  # eq. (2)
MULTIMODAL = Function("multi-modal", _peaks, 1.0)  # eq. (3), to be minimised
RASTRIGIN = Function("Rastrigin", _rastrigin, 5.0)  # eq. (4)


@dataclass(frozen=True)
class Stage:
    """Steps of one kind in a row, as a search took them."""

    name: str
    batches: list[Array]  # points of the unit cube evaluated in each step
    minima: Array  # (n, 2) known at the end

    @property
    def points(self) -> Array:
        """All points of the stage."""
        return np.vstack(self.batches)


def watched(function: Function, seed: int, profile: Profile) -> list[Stage]:
    """Run a search by hand; return its steps, those of one name in a row together."""
    search = Search([function.ends] * 2, rng=seed, profile=profile)
    record, seen, step = search.record, 0, 0
    stages: list[Stage] = []
    while not search.done:
        search.tell(function.fun(search.ask()))
        if record.nit == step:
            continue
        if not stages or stages[-1].name != record.stage:
            stages.append(Stage(record.stage, [], np.empty((0, 2))))
        stages[-1].batches.append(record.points[seen:])
        stages[-1] = Stage(record.stage, stages[-1].batches, record.minima.sorted()[0])
        seen, step = record.nfev, record.nit
    return stages


def bred(function: Function, seed: int, *, generations: int) -> Iterator[tuple[Colony, Record]]:
    """Yield a colony at its foundation and after each generation, and the record of its evaluations."""
    record = Record(2, same_point=SEED.same_point)
    colony = Colony(_UNIT, rng=np.random.default_rng(seed), settings=SEED)
    answered(colony.create_founders(), function, record)
    yield colony, record
    for _ in range(generations):
        answered(colony.advance(), function, record)
        yield colony, record


def answered(part: Evaluations[T], function: Function, record: Record) -> T:
    """Give a part of a search the values it asks for; return its finding."""
    try:
        points = next(part)
        while True:
            values = function.at(points)
            record.add(points, values)
            points = part.send(values)
    except StopIteration as end:
        return end.value


def clustered(colony: Colony) -> Clustering:
    """Return the clusters of a colony, classified best first as the search does."""
    order = colony.fun.argsort(kind="stable")
    found = cluster(colony.points[order], SEED)
    labels = np.empty_like(found.labels)
    labels[order] = found.labels
    return Clustering(labels=labels, similarity=found.similarity, cef=found.cef)
