"""Functions with many global minima, for the question whether all of them are listed; all to be minimised.

Shubert's and Vincent's, the six-hump camel, Himmelblau's and the modified Rastrigin function of 12 minima are those of
Li, Engelbrecht and Epitropakis, Benchmark Functions for CEC'2013 Special Session on Niching Methods (there maximised),
on boxes of their own and with their budgets. The compositions are made here, after the recipe there: every minimum lies
at the bottom of a rotated basic function of its own, and what is felt of each falls off with distance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import special_ortho_group

from benchmarks.parts.chea.functions import (
    HUMPS,
    VINCENT_BOX,
    VINCENT_PLACES,
    Case,
    Fun,
    Grid,
    Listed,
    ShubertMinima,
    ackley,
    camel,
    cube,
    griewank,
    rastrigin,
    shubert,
    vincent,
)

Array = NDArray[np.float64]

HIMMELBLAU = np.array(
    [[3.0, 2.0], [-2.805118086952745, 3.131312518250573], [-3.779310253377747, -3.283185991286170],
     [3.584428340330492, -1.848126526964404]]
)  # fmt: skip
RIDGES = (3, 4)  # minima of the modified Rastrigin function along each parameter
APART = 2.5  # the least distance of a composition's minima, in a box of 10
REACH = 0.5  # how far each is felt, per square root of the dimension
HEIGHT = 100.0  # of every basic function at the corner of the box


def himmelblau(x: Array) -> Array:
    """Return Himmelblau's function: four minima, all global."""
    a, b = x.T
    return (a**2 + b - 11) ** 2 + (a + b**2 - 7) ** 2


def ridged(x: Array) -> Array:
    """Return the modified Rastrigin function: 3 by 4 minima in the unit square, all global, value 2."""
    return (10 + 9 * np.cos(2 * np.pi * np.array(RIDGES) * x)).sum(axis=1)


def sphere(x: Array) -> Array:
    """Return the squared distance from the origin."""
    return (x**2).sum(axis=1)


@dataclass(frozen=True)
class Composition:
    """A function of several global minima of value 0, each with ground of its own kind about it."""

    places: Array  # (m, dim) of the minima
    axes: Array  # (m, dim, dim) orthogonal
    basics: tuple[Fun, ...]  # (m,)
    heights: Array  # (m,) what each is divided by

    def __call__(self, x: Array) -> Array:
        """Return the values (n,) at points (n, dim)."""
        away = x[:, None] - self.places
        felt = np.exp(-(away**2).sum(axis=2) / (2 * REACH**2 * x.shape[1]))
        strongest = felt.max(axis=1, keepdims=True)
        felt = np.where(felt == strongest, felt, felt * (1 - strongest**10)) + np.finfo(float).tiny
        felt /= felt.sum(axis=1, keepdims=True)
        turned = np.einsum("nmi,mij->mnj", away, self.axes)
        values = [HEIGHT * basic(t) / h for basic, t, h in zip(self.basics, turned, self.heights, strict=True)]
        return (felt * np.array(values).T).sum(axis=1)


def composition(name: str, dim: int, basics: Sequence[Fun], *, seed: int) -> Case:
    """Return a function with a minimum for each of `basics`, at places of its own in (-5, 5)^dim."""
    rng = np.random.default_rng([7, dim, seed])
    places = np.empty((0, dim))
    while len(places) < len(basics):
        place = rng.uniform(-4.5, 4.5, dim)
        if not len(places) or np.linalg.norm(places - place, axis=1).min() >= APART:
            places = np.vstack([places, place])
    axes = special_ortho_group.rvs(dim, size=len(basics), random_state=rng).reshape(-1, dim, dim)
    corner = np.full((1, dim), 5.0)
    heights = np.array([float(basic(corner)[0]) for basic in basics])
    fun = Composition(places, axes, tuple(basics), heights)
    return Case(name=f"{name} {dim}", fun=fun, bounds=cube(5.0, dim), minima=Listed(places))


SMOOTH = (sphere, griewank, sphere, griewank, sphere, griewank)
RUGGED = (rastrigin, griewank, ackley, sphere, rastrigin, griewank, ackley, sphere)


def niching_cases() -> list[tuple[Case, int]]:
    """Return the functions, each with its budget of calls."""
    few, many, deep = 50_000, 200_000, 400_000
    return [
        (Case(name="camel 2", fun=camel, bounds=np.array([[-1.9, 1.9], [-1.1, 1.1]]), minima=Listed(HUMPS)), few),
        (Case(name="Himmelblau 2", fun=himmelblau, bounds=cube(6.0, 2), minima=Listed(HIMMELBLAU)), few),
        (
            Case(
                name="modified Rastrigin 2",
                fun=ridged,
                bounds=np.array([[0.0, 1.0], [0.0, 1.0]]),
                minima=Listed(np.array([[(2 * i + 1) / 6, (2 * j + 1) / 8] for i in range(3) for j in range(4)])),
            ),
            many,
        ),
        *(
            (Case(name=f"Shubert {d}", fun=shubert, bounds=cube(10.0, d), minima=ShubertMinima(d)), budget)
            for d, budget in ((2, many), (3, deep))
        ),
        *(
            (
                Case(
                    name=f"Vincent {d}",
                    fun=vincent,
                    bounds=VINCENT_BOX.repeat(d, 0),
                    minima=Grid(VINCENT_PLACES, d),
                ),
                budget,
            )
            for d, budget in ((2, many), (3, deep))
        ),
        *((composition("smooth", d, SMOOTH, seed=0), many if d < 3 else deep) for d in (2, 3, 5, 10)),
        *((composition("rugged", d, RUGGED, seed=0), many if d < 3 else deep) for d in (2, 3, 5, 10)),
    ]
