"""`Search`: the algorithm as an ask/tell object, for whoever calls the objective himself."""

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.profiles import Local, Profile, begin
from rotorrig.identify.chea.session import (
    Box,
    CheaResult,
    Evaluations,
    Record,
    SearchState,
    Stop,
    StopReason,
    assemble,
    from_bounds,
)

Array = NDArray[np.float64]


class Search:
    """A minimisation that asks for values: `while not search.done: search.tell(fun(x) for x in search.ask())`.

    `state`, or a pickle, holds what the search began with and every value told. Resuming tells them again, without a
    call of the objective, and the search goes on exactly as it would have.

    >>> search = Search([(-5, 5), (-5, 5)], rng=1)
    >>> while not search.done:
    ...     search.tell((x[0] - 3) ** 2 + (x[1] - 1) ** 2 for x in search.ask())
    >>> search.result().x.round(4).tolist()
    [3.0, 1.0]
    """

    record: Record
    _start: SearchState  # without any values yet
    _plan: Evaluations[StopReason]  # the algorithm
    _waiting: Array  # (n, dim) what it asked for, in the unit cube
    _told: int  # how many of these have their values
    _reason: StopReason | None  # why it ended by itself, if it did
    _failure: str  # why fun failed at first

    def __init__(
        self,
        bounds: Box,
        *,
        rng: np.random.Generator | int | None = None,
        profile: Profile = "modern",
        settings: Any = None,
        local: Local | None = None,
        stop: Stop = "natural",
        x_scale: str | Sequence[str] = "linear",
    ) -> None:
        """Begin a search; the arguments are those of `chea`. Raises ValueError on an unusable one.

        The search has a generator of its own, seeded by a draw from `rng`: what the caller draws later from his does
        not change where a resumed search goes.
        """
        seed = np.random.default_rng(rng).integers(2**32, size=4).tolist()
        scaling = from_bounds(bounds, x_scale)
        chosen = {"profile": profile, "settings": settings, "local": local, "stop": stop}
        self._begin(SearchState(scaling=scaling, seed=tuple(seed), **chosen))

    @classmethod
    def resume(cls, state: SearchState) -> Self:
        """Return the search as it was. Raises ValueError if this version of the algorithm asks for other points."""
        search = cls.__new__(cls)
        search._begin(replace(state, values=np.empty(0), checksum=0))
        search._replay(state)
        return search

    @property
    def state(self) -> SearchState:
        """The search as plain data, as of now."""
        values, checksum = self.record.values.copy(), _checksum(self.record.points)
        return replace(self._start, values=values, checksum=checksum, failure=self._failure)

    @property
    def done(self) -> bool:
        """True once the search has ended by itself."""
        return self._reason is not None

    def ask(self) -> Array:
        """Return the parameters (n, dim) whose values are awaited; none when the search is done."""
        return self._start.scaling.to_parameters(self._waiting[self._told :])

    def tell(self, values: Iterable[float], *, failure: str = "") -> None:
        """Take the values of the first points asked for, of all or fewer. Not finite means failed; `failure` says why.

        Raises ValueError if there are more values than points asked for.
        """
        f = np.fromiter(values, dtype=np.float64)
        awaited = self._waiting[self._told :]
        if len(f) > len(awaited):
            raise ValueError(f"told {len(f)} values, expected at most {len(awaited)}: one for each point asked for")
        if len(f) == 0:
            return
        self._failure = self._failure or failure
        self.record.add(awaited[: len(f)], f)
        self._told += len(f)
        if self._told == len(self._waiting):
            self._advance(self.record.values[-self._told :].copy())

    def result(self, reason: StopReason | None = None) -> CheaResult:
        """Return what is known now; `reason` says why a search that is not done was ended."""
        return assemble(self.record, self.state, reason or self._reason or StopReason.UNFINISHED)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the state; the generators of a search under way cannot be."""
        return Search.resume, (self.state,)

    def _begin(self, start: SearchState) -> None:
        self._start = start
        self._failure = start.failure
        self._reason = None
        rng = np.random.Generator(np.random.PCG64(start.seed))
        self.record, self._plan = begin(
            start.profile, start.settings, start.scaling.dim, rng, local=start.local, stop=start.stop
        )
        self._advance(None)

    def _advance(self, values: Array | None) -> None:
        """Send the plan its values, None to begin with, and wait at the next points it wants to have evaluated."""
        self._told = 0
        try:
            self._waiting = next(self._plan) if values is None else self._plan.send(values)
            while not len(self._waiting):
                self._waiting = self._plan.send(np.empty(0))
        except StopIteration as end:
            self._reason = end.value
            self._waiting = np.empty((0, self.record.dim))

    def _replay(self, state: SearchState) -> None:
        values = state.values
        while len(values) and not self.done:
            n = len(self._waiting)
            self.tell(values[:n])
            values = values[n:]
        if len(values) or _checksum(self.record.points) != state.checksum:
            raise ValueError("this search was begun by another version of the algorithm, and cannot be resumed")


def _checksum(points: Array) -> int:
    return zlib.crc32(points.tobytes())
