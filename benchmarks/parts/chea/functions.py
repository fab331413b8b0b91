"""Test functions of global optimisation, each with its box and all of its global minima; all to be minimised.

The chapter's three, on its boxes and on boxes moved at random, and the usual ones beyond two dimensions. Sources:

- the chapter's eqs. (2) to (4), with what the print lost put back: Rosenbrock's square, Rastrigin's cos(2 pi x_i);
- Surjanovic and Bingham, Virtual Library of Simulation Experiments, www.sfu.ca/~ssurjano: Ackley, Griewank, Schwefel,
  Levy, six-hump camel, Branin, Hartmann, Shubert;
- Li, Engelbrecht and Epitropakis, Benchmark Functions for CEC'2013 Special Session on Niching Methods: Vincent, and
  the number of global minima of Shubert's (d 3^d) and Vincent's (6^d).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from scipy.stats import special_ortho_group

Array = NDArray[np.float64]
Fun = Callable[[Array], Array]  # points (n, dim) -> values (n,)


class Minima(Protocol):
    """All global minima of a function."""

    @property
    def count(self) -> int:
        """How many there are."""

    def nearest(self, x: Array) -> Array:
        """Return, for points (n, dim), the nearest global minimum to each, (n, dim)."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A function on a box, as one run meets it."""

    fun: Fun
    bounds: Array  # (dim, 2)
    minima: Minima
    tolerance: Array  # (dim,) a minimum is found by a point this close in every parameter

    @property
    def dim(self) -> int:
        """Number of parameters."""
        return len(self.bounds)


@dataclass(frozen=True, kw_only=True)
class Case:
    """A function, its usual box, and what a seed does to them, so that no method gains from where the minimum sits."""

    name: str
    fun: Fun
    bounds: Array  # (dim, 2)
    minima: Minima
    shift: float = 0.0  # the middle of the box moves by up to this part of its half width
    turn: Literal["", "rotated", "mirrored"] = ""  # about the origin; mirrored: the signs of the parameters
    tolerance: float | None = None  # of x; None: 1e-3 of the box's half width

    @property
    def dim(self) -> int:
        """Number of parameters."""
        return len(self.bounds)

    def problem(self, seed: int) -> Problem:
        """Return the function on the box of this seed; the same for every method."""
        rng = np.random.default_rng([1, seed])
        half = np.ptp(self.bounds, axis=1) / 2
        moved = self.bounds + (rng.uniform(-self.shift, self.shift, self.dim) * half)[:, None]
        axes = self._axes(rng)
        return Problem(
            fun=self.fun if axes is None else lambda x: self.fun(x @ axes.T),
            bounds=moved,
            minima=self.minima if axes is None else Turned(self.minima, axes),
            tolerance=1e-3 * half if self.tolerance is None else np.full(self.dim, self.tolerance),
        )

    def _axes(self, rng: np.random.Generator) -> Array | None:
        """Return an orthogonal matrix (dim, dim), or None."""
        if self.turn == "rotated":
            return special_ortho_group.rvs(self.dim, random_state=rng)
        if self.turn == "mirrored":
            return np.diag(rng.choice([-1.0, 1.0], self.dim))
        return None


@dataclass(frozen=True)
class Listed:
    """A few global minima, (m, dim)."""

    points: Array

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.points)

    def nearest(self, x: Array) -> Array:
        """Return the nearest to each of points (n, dim)."""
        return self.points[cdist(x, self.points, "chebyshev").argmin(axis=1)]


@dataclass(frozen=True)
class Grid:
    """Global minima wherever every parameter is at one of the same places, (m,): m^dim of them."""

    places: Array
    dim: int

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.places) ** self.dim

    def nearest(self, x: Array) -> Array:
        """Return the nearest to each of points (n, dim)."""
        return _nearest_place(x, self.places)


@dataclass(frozen=True)
class ShubertMinima:
    """Shubert's function is a product of g(x_i); least where one factor is at its low and all others at their high."""

    dim: int

    @property
    def count(self) -> int:
        """How many there are."""
        return self.dim * 3**self.dim

    def nearest(self, x: Array) -> Array:
        """Return the nearest to each of points (n, dim)."""
        low, high = _nearest_place(x, SHUBERT_LOWS), _nearest_place(x, SHUBERT_HIGHS)
        at_low = np.eye(self.dim, dtype=np.bool_)  # which parameter is the low one
        choices = np.where(at_low, low[:, None], high[:, None])  # (n, dim choices, dim)
        best = np.abs(choices - x[:, None]).max(axis=2).argmin(axis=1)
        return choices[np.arange(len(x)), best]


@dataclass(frozen=True)
class Turned:
    """The minima of fun(x @ axes.T), given those of fun."""

    minima: Minima
    axes: Array  # (dim, dim) orthogonal

    @property
    def count(self) -> int:
        """How many there are."""
        return self.minima.count

    def nearest(self, x: Array) -> Array:
        """Return the nearest to each of points (n, dim), as nearest before the turn."""
        return self.minima.nearest(x @ self.axes.T) @ self.axes


def _nearest_place(x: Array, places: Array) -> Array:
    return places[np.abs(x[..., None] - places).argmin(axis=-1)]


def banana(x: Array) -> Array:
    """Return eq. (2), Rosenbrock's valley."""
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


def multimodal(x: Array) -> Array:
    """Return eq. (3) as printed: negative; what the chapter maximises is its opposite."""
    u, v = np.pi * x.T
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))


def rastrigin(x: Array) -> Array:
    """Return eq. (4), for any number of parameters."""
    return (10 + x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


def ackley(x: Array) -> Array:
    """Return Ackley's function, a funnel with a rippled floor."""
    far, ripple = np.sqrt((x**2).mean(axis=1)), np.cos(2 * np.pi * x).mean(axis=1)
    return -20 * np.exp(-0.2 * far) - np.exp(ripple) + 20 + np.e


def griewank(x: Array) -> Array:
    """Return Griewank's function, a wide bowl with ripples that are small beside it."""
    scale = np.sqrt(np.arange(1, x.shape[1] + 1))
    return (x**2).sum(axis=1) / 4000 - np.cos(x / scale).prod(axis=1) + 1


def schwefel(x: Array) -> Array:
    """Return Schwefel's function: the best minimum near a corner, the second best far from it."""
    return (418.9828872724339 - x * np.sin(np.sqrt(np.abs(x)))).sum(axis=1)


def levy(x: Array) -> Array:
    """Return Levy's function, a rippled bowl whose parameters go together."""
    w = 1 + (x - 1) / 4
    inner = (w[:, :-1] - 1) ** 2 * (1 + 10 * np.sin(np.pi * w[:, :-1] + 1) ** 2)
    last = (w[:, -1] - 1) ** 2 * (1 + np.sin(2 * np.pi * w[:, -1]) ** 2)
    return np.sin(np.pi * w[:, 0]) ** 2 + inner.sum(axis=1) + last


def camel(x: Array) -> Array:
    """Return the six-hump camel: six minima, two of them global."""
    a, b = x.T
    return (4 - 2.1 * a**2 + a**4 / 3) * a**2 + a * b + (4 * b**2 - 4) * b**2


def branin(x: Array) -> Array:
    """Return Branin's function: three minima, all global."""
    a, b = x.T
    return (b - 5.1 / (4 * np.pi**2) * a**2 + 5 / np.pi * a - 6) ** 2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(a) + 10


def hartmann(x: Array, *, sharpness: Array, pits: Array) -> Array:
    """Return Hartmann's function of four pits; `sharpness` and `pits` are (4, dim)."""
    away = (sharpness * (x[:, None] - pits) ** 2).sum(axis=2)
    return -np.exp(-away) @ np.array([1.0, 1.2, 3.0, 3.2])


def shubert(x: Array) -> Array:
    """Return the product over all parameters of g(x) = sum over j = 1..5 of j cos((j + 1) x + j)."""
    j = np.arange(1, 6)
    return (j * np.cos((j + 1) * x[..., None] + j)).sum(axis=2).prod(axis=1)


def vincent(x: Array) -> Array:
    """Return Vincent's function: every minimum global, the narrowest a twentieth as wide as the widest."""
    return -np.sin(10 * np.log(x)).mean(axis=1)


UNIT, VINCENT_BOX = np.array([[0.0, 1.0]]), np.array([[0.25, 10.0]])
PEAKS = np.array([[a * 0.43880, b * 0.30585] for a in (1, -1) for b in (1, -1)])  # the chapter's Table 3
HUMPS = np.array([[0.08984201, -0.71265640], [-0.08984201, 0.71265640]])
VALLEYS = np.array([[-np.pi, 12.275], [np.pi, 2.275], [3 * np.pi, 2.475]])
PIT_3 = np.array([[0.114614, 0.555649, 0.852547]])
PIT_6 = np.array([[0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573]])
SHUBERT_LOWS = -1.42512843 + 2 * np.pi * np.arange(-1, 2)
SHUBERT_HIGHS = -0.80032110 + 2 * np.pi * np.arange(-1, 2)
VINCENT_PLACES = np.exp((np.pi / 2 + 2 * np.pi * np.arange(-2, 4)) / 10)
HARTMANN_3 = {
    "sharpness": np.array([[3, 10, 30], [0.1, 10, 35], [3, 10, 30], [0.1, 10, 35]]),
    "pits": 1e-4 * np.array([[3689, 1170, 2673], [4699, 4387, 7470], [1091, 8732, 5547], [381, 5743, 8828]]),
}
HARTMANN_6 = {
    "sharpness": np.array(
        [
            [10, 3, 17, 3.5, 1.7, 8],
            [0.05, 10, 17, 0.1, 8, 14],
            [3, 3.5, 1.7, 10, 17, 8],
            [17, 8, 0.05, 10, 0.1, 14],
        ]
    ),
    "pits": 1e-4
    * np.array(
        [
            [1312, 1696, 5569, 124, 8283, 5886],
            [2329, 4135, 8307, 3736, 1004, 9991],
            [2348, 1451, 3522, 2883, 3047, 6650],
            [4047, 8828, 8732, 5743, 1091, 381],
        ]
    ),
}


def cube(half: float, dim: int) -> Array:
    """Return the bounds (dim, 2) of a cube about the origin.

    >>> cube(2.0, 2).tolist()
    [[-2.0, 2.0], [-2.0, 2.0]]
    """
    return np.tile([-half, half], (dim, 1))


def chapter_cases() -> list[Case]:
    """Return eqs. (2) to (4): f1 to f3 on the chapter's boxes, s on shifted ones, r rotated and shifted."""
    valley = partial(Case, fun=banana, bounds=cube(2.0, 2), minima=Listed(np.ones((1, 2))), tolerance=1e-3)
    peaks = partial(Case, fun=multimodal, bounds=cube(1.0, 2), minima=Listed(PEAKS), tolerance=1e-3)
    ripples = partial(Case, fun=rastrigin, bounds=cube(5.0, 2), minima=Listed(np.zeros((1, 2))), tolerance=1e-3)
    return [
        valley(name="f1"),
        peaks(name="f2"),
        ripples(name="f3"),
        valley(name="f1s", shift=0.4),
        peaks(name="f2s", shift=0.4),
        ripples(name="f3s", shift=0.6),
        ripples(name="f3r", shift=0.6, turn="rotated"),
    ]


def cases_beyond() -> list[Case]:
    """Return the usual functions of 2 to 10 dimensions.

    Boxes with the minimum in or near the middle are shifted. Schwefel's lets in deeper minima when it is: there the
    signs of the parameters are turned.
    """
    dims = (2, 5, 10)
    zero, one, corner = ({d: Listed(np.full((1, d), place)) for d in dims} for place in (0.0, 1.0, 420.968746))
    shifted = partial(Case, shift=0.6)
    return [
        *(shifted(name=f"Ackley {d}", fun=ackley, bounds=cube(32.768, d), minima=zero[d]) for d in dims),
        *(shifted(name=f"Griewank {d}", fun=griewank, bounds=cube(600.0, d), minima=zero[d]) for d in dims),
        *(shifted(name=f"Levy {d}", fun=levy, bounds=cube(10.0, d), minima=one[d]) for d in dims),
        *(
            shifted(name=f"Rastrigin {d}", fun=rastrigin, bounds=cube(5.12, d), minima=zero[d], turn="rotated")
            for d in dims
        ),
        *(
            Case(name=f"Schwefel {d}", fun=schwefel, bounds=cube(500.0, d), minima=corner[d], turn="mirrored")
            for d in dims
        ),
        Case(name="camel 2", fun=camel, bounds=np.array([[-3.0, 3.0], [-2.0, 2.0]]), minima=Listed(HUMPS)),
        Case(name="Branin 2", fun=branin, bounds=np.array([[-5.0, 10.0], [0.0, 15.0]]), minima=Listed(VALLEYS)),
        Case(name="Hartmann 3", fun=partial(hartmann, **HARTMANN_3), bounds=UNIT.repeat(3, 0), minima=Listed(PIT_3)),
        Case(name="Hartmann 6", fun=partial(hartmann, **HARTMANN_6), bounds=UNIT.repeat(6, 0), minima=Listed(PIT_6)),
        *(Case(name=f"Shubert {d}", fun=shubert, bounds=cube(10.0, d), minima=ShubertMinima(d)) for d in dims),
        *(
            Case(name=f"Vincent {d}", fun=vincent, bounds=VINCENT_BOX.repeat(d, 0), minima=Grid(VINCENT_PLACES, d))
            for d in dims
        ),
    ]
