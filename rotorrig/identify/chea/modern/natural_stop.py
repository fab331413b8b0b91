"""`NaturalStop`: the natural end of a search, from its minima and the calls they took."""

from dataclasses import dataclass

from rotorrig.identify.chea.modern.settings import MODERN


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
