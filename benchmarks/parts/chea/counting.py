"""Every call of a function counted, whoever makes it: a method, its finite differences, or a batch of points."""

import numpy as np

from benchmarks.parts.chea.functions import Array, Fun


class BudgetSpent(Exception):
    """Raised in place of a call beyond the budget; the best point until then is kept."""


class Counted:
    """A function that counts its calls, keeps the best point, and refuses to be called beyond its budget.

    >>> fun = Counted(lambda x: (x**2).sum(axis=1), budget=3)
    >>> fun(np.array([1.0, 2.0])), fun.batch(np.array([[0.0, 1.0], [3.0, 0.0]])).tolist(), fun.calls
    (5.0, [1.0, 9.0], 3)
    """

    def __init__(self, fun: Fun, *, budget: int | None = None) -> None:
        """Count the calls of `fun`, (n, dim) -> (n,); no budget: any number."""
        self.budget = budget
        self.calls = 0
        self.best_x = np.empty(0)
        self.best_fun = np.inf
        self._fun = fun

    def __call__(self, x: Array) -> float:
        """Return the value at a point (dim,). Raises BudgetSpent."""
        return float(self.batch(np.array(x, dtype=np.float64)[None])[0])

    def batch(self, x: Array) -> Array:
        """Return the values (n,) at points (n, dim). Raises BudgetSpent unless all of them are within the budget."""
        if self.budget is not None and self.calls + len(x) > self.budget:
            raise BudgetSpent
        values = self._fun(x)
        self.calls += len(x)
        least = int(np.argmin(values))
        if values[least] < self.best_fun:
            self.best_x, self.best_fun = x[least].copy(), float(values[least])
        return values
