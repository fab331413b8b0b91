"""The best with the holes and masses at hand: which mass into which hole, exactly.

By least squares the cost of masses W is that of the best correction plus (W - W0)^H H^H H (W - W0). What the holes of
one plane can hold is listed; the planes are searched one after the other, the nearest first, and a branch is left as
soon as its bound passes the best found (branch and bound; of the last plane a k-d tree gives the nearest).
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from rotorrig.rig import DataError

Complex = NDArray[np.complex128]
Reals = NDArray[np.float64]

MOST_PLACINGS = 400_000  # ways to fill one plane that are listed
MIN_MAX_CANDIDATES = 300  # of lowest sum of squares, among which the least maximum is looked for


@dataclass(frozen=True, slots=True, kw_only=True)
class Holes:
    """Holes of a plane and what fits into them: hole 1 is at `first` from the mark, the next in the sense of rotation.

    Every hole takes one of the masses or none; there are enough of each.
    """

    count: int
    masses: tuple[float, ...]  # kg
    radius: float  # m
    first: float = 0.0  # rad
    most: int = 2  # holes of a plane that are filled

    def vector(self, hole: int, mass: float) -> complex:
        """Return the unbalance [kg m] of a mass in a hole, counted from 1."""
        return complex(mass * self.radius * np.exp(1j * (self.first + math.tau * (hole - 1) / self.count)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Placing:
    """Masses in the holes of every plane."""

    holes: tuple[Holes, ...]  # (plane,)
    filled: tuple[tuple[tuple[int, float], ...], ...]  # plane -> (hole from 1, kg)
    W: Complex  # (plane,) kg m


def count_placings(holes: Holes) -> int:
    """Return in how many ways a plane can be filled.

    >>> count_placings(Holes(count=4, masses=(1e-3, 2e-3), radius=0.03, most=2))  # none, 4 x 2, 6 x 4
    33
    """
    return sum(math.comb(holes.count, n) * len(holes.masses) ** n for n in range(min(holes.most, holes.count) + 1))


def place_masses(W0: Complex, H: Complex, holes: Sequence[Holes], *, z: Complex | None = None) -> Placing:
    """Return the placing nearest to the correction W0 as the probes see it; with `z` that of least maximum |z + H W|.

    The latter is found among the placings of lowest sum of squares. Raises DataError if there are too many to list.
    """
    tables = [_list_placings(each) for each in holes]
    R = np.linalg.qr(H)[1]
    found = _search(R, W0, [vectors for _, vectors in tables], most=1 if z is None else MIN_MAX_CANDIDATES)
    if z is not None:
        at = np.array([[vectors[i] for i, (_, vectors) in zip(c, tables, strict=True)] for c in found])
        found = [found[int(np.argmin(np.abs(z + at @ H.T).max(axis=1)))]]
    return Placing(
        holes=tuple(holes),
        filled=tuple(table[i] for i, (table, _) in zip(found[0], tables, strict=True)),
        W=np.array([vectors[i] for i, (_, vectors) in zip(found[0], tables, strict=True)]),
    )


def _list_placings(holes: Holes) -> tuple[list[tuple[tuple[int, float], ...]], Complex]:
    """Return all ways to fill a plane, and their unbalance; of those alike the one of fewest masses."""
    if (count := count_placings(holes)) > MOST_PLACINGS:
        raise DataError(
            f"{holes.count} holes, {len(holes.masses)} masses and {holes.most} filled per plane make {count} "
            f"placings, want at most {MOST_PLACINGS}: fill fewer holes"
        )
    table = [
        tuple(zip(chosen, masses, strict=True))
        for n in range(min(holes.most, holes.count) + 1)
        for chosen in itertools.combinations(range(1, holes.count + 1), n)
        for masses in itertools.product(holes.masses, repeat=n)
    ]
    vectors = np.array([sum((holes.vector(hole, mass) for hole, mass in placing), 0j) for placing in table])
    step = max(holes.masses) * holes.radius * 1e-9
    _, first = np.unique(np.round(np.stack([vectors.real, vectors.imag]) / step), axis=1, return_index=True)
    first = np.sort(first)
    return [table[i] for i in first], vectors[first]


def _search(R: Complex, W0: Complex, choices: Sequence[Complex], *, most: int) -> list[tuple[int, ...]]:
    """Return the `most` choices per plane with the least |R (W - W0)|, best first."""
    best: list[tuple[float, tuple[int, ...]]] = []
    tree = cKDTree(np.stack([choices[0].real, choices[0].imag], axis=1))

    def descend(plane: int, chosen: tuple[int, ...], spent: float) -> None:
        rest = sum((R[plane, j] * (choices[j][i] - W0[j]) for j, i in zip(_above(plane, R), chosen, strict=True)), 0j)
        centre, scale = W0[plane] - rest / R[plane, plane], abs(R[plane, plane]) ** 2
        if plane == 0:
            near = min(most, len(choices[0]))
            apart, index = tree.query([centre.real, centre.imag], k=near)
            for d, i in zip(np.atleast_1d(apart), np.atleast_1d(index), strict=True):
                if not _keep(best, (spent + scale * d**2, (int(i), *chosen)), most):
                    break
            return
        cost = spent + scale * np.abs(choices[plane] - centre) ** 2
        for i in np.argsort(cost, kind="stable"):
            if len(best) == most and cost[i] >= best[-1][0]:
                break
            descend(plane - 1, (int(i), *chosen), float(cost[i]))

    descend(len(choices) - 1, (), 0.0)
    return [chosen for _, chosen in best]


def _above(plane: int, R: Complex) -> range:
    return range(plane + 1, len(R))


def _keep(best: list[tuple[float, tuple[int, ...]]], candidate: tuple[float, tuple[int, ...]], most: int) -> bool:
    """Insert a candidate if it is among the best; say whether it was."""
    if len(best) == most and candidate[0] >= best[-1][0]:
        return False
    best.append(candidate)
    best.sort()
    del best[most:]
    return True
