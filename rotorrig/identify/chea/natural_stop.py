"""`NaturalStop`: when a search has seen enough, told from what it found and what that took."""

from dataclasses import dataclass

AGREEING = 3  # descents, if they all lead to one minimum


@dataclass(slots=True, kw_only=True)
class NaturalStop:
    """Weighs the minima against the descents and the calls that led there.

    A function all of whose descents end in one place is settled by three of them. Each further minimum asks for more,
    up to a limit. From then on it counts whether looking on was lately of use: the search ends when the calls since the
    last find, a lower value or another minimum as low, exceed `patience` times those until then; with m minima sharing
    the best value an m-th of that, for a value met in several places is seldom undercut in yet another.
    """

    patience: float
    idle: int  # calls without a find that are enough in any case
    per_minimum: int
    most: int  # descents that are enough for any number of minima
    descents: int = 0
    last_find: int = 0  # calls until then
    _best: float = float("inf")
    _ties: int = 1

    def found(self, best: float, ties: int, *, margin: float, nfev: int) -> None:
        """Take note of the lowest minimum, of how many are as low but for `margin`, and of the calls until now."""
        if best < self._best - margin or ties > self._ties:
            self.last_find = nfev
        self._best, self._ties = best, ties

    def too_few(self, minima: int) -> bool:
        """Return whether this many minima ask for more descents than there have been."""
        return self.descents < min(AGREEING + self.per_minimum * max(minima - 1, 0), self.most)

    def reached(self, minima: int, nfev: int) -> bool:
        """Return whether a search with this many minima and calls may end."""
        wanted = min(self.patience * (1 - 1 / max(minima, 1)) * self.last_find, self.idle)
        return not self.too_few(minima) and nfev - self.last_find >= wanted / self._ties
