"""The natural end of a search: `Finds` among its minima, and what `NaturalStop` makes of the calls they took."""

from dataclasses import dataclass

import numpy as np

from rotorrig.identify.chea.engine import Engine
from rotorrig.identify.chea.modern.settings import MODERN, ModernSettings


@dataclass(slots=True, kw_only=True)
class NaturalStop:
    """Weighs the minima against the descents and the calls that led there.

    A function all of whose descents end in one place is settled by a few. Each further minimum asks for more,
    up to a limit. From then on it counts whether looking on was lately of use: the search ends when the calls since the
    last find, a lower minimum or another as low, exceed `patience` times those until then, or `idle`. The former is
    half or a third when two or more minima share the best value, which is seldom undercut in yet another place.
    """

    patience: float
    idle: int  # calls without a find that are enough in any case
    per_minimum: int
    most: int  # descents that are enough for any number of minima
    agreeing: int = MODERN.agreeing  # descents that are enough for one minimum
    shared: int = MODERN.shared  # minima with the best value that count
    descents: int = 0
    last_find: int = 0  # calls until then
    _ties: int = 1

    def note_minimum(self, *, lower: bool, ties: int, nfev: int) -> None:
        """Take note of a minimum: whether it is the lowest yet, how many are as low now, and the calls until now."""
        if lower or ties > self._ties:
            self.last_find = nfev
        self._ties = ties

    def too_few(self, minima: int) -> bool:
        """Return whether this many minima ask for more descents than there have been."""
        return self.descents < min(self.agreeing + self.per_minimum * max(minima - 1, 0), self.most)

    def is_reached(self, minima: int, nfev: int) -> bool:
        """Return whether a search with this many minima and calls may end."""
        patience = self.patience * (1 - 1 / max(minima, 1)) / min(self._ties, self.shared)
        return not self.too_few(minima) and nfev - self.last_find >= min(patience * self.last_find, self.idle)


class Finds:
    """Minima lower than all before, or as low as the best, and the calls they took."""

    def __init__(self, dim: int, settings: ModernSettings) -> None:
        self._settings = settings
        self._lowest = np.full(dim, np.inf), np.inf
        self._stop = NaturalStop(
            patience=settings.patience,
            idle=settings.idle * (dim + 1),
            per_minimum=settings.per_minimum,
            most=settings.descents + settings.descents_per_parameter * dim,
            agreeing=settings.agreeing,
            shared=settings.shared,
        )

    def usual(self, engine: Engine) -> float:
        """Return the median of the even sample."""
        sample = engine.values[: self._settings.sample * (engine.record.dim + 1)]
        return float(np.median(sample[np.isfinite(sample)]))

    def margin(self, engine: Engine) -> float:
        """Return how far above the best value a minimum may lie that shares it."""
        return self._settings.tie * (self.usual(engine) - engine.record.minima.best)

    def note(self, engine: Engine) -> None:
        """Take note of a minimum: a lower value elsewhere, or one as low, is a find."""
        u, values, _ = engine.record.minima.sorted()
        margin = self.margin(engine)
        before, fun_before = self._lowest
        elsewhere = np.abs(u[0] - before).max() > self._settings.same_point
        self._stop.note_minimum(
            lower=bool(values[0] < fun_before - margin and elsewhere),
            ties=int((values <= values[0] + margin).sum()),
            nfev=engine.record.nfev,
        )
        self._lowest = u[0], float(values[0])

    def too_few(self, engine: Engine) -> bool:
        """Return whether the minima ask for more descents than there have been."""
        self._stop.descents = engine.descents
        return self._stop.too_few(len(engine.record.minima))

    def are_over(self, engine: Engine) -> bool:
        """Return whether nothing more is to be expected, after one round at least."""
        self._stop.descents = engine.descents
        return engine.rounds > 0 and self._stop.is_reached(len(engine.record.minima), engine.record.nfev)
