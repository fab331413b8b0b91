"""`Finds`: what the minima of a search say about going on."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import Engine
from rotorrig.identify.chea.modern.natural_stop import NaturalStop
from rotorrig.identify.chea.modern.settings import ModernSettings

Array = NDArray[np.float64]


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

    def note(self, engine: Engine) -> None:
        """Take note of a minimum: a lower value elsewhere, or one as low, is a find."""
        u, values, _ = engine.record.minima.sorted()
        margin = self._settings.tie * (self.usual(engine) - values[0])
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
