"""Identifiability of the unknowns from a response: singular directions of the Fisher information, and what limits each.

Unknowns are measured in relative changes (radians for phases, parts of the direct coefficient for cross ones), so that
a singular value is one over a relative uncertainty. Two informations are looked at:

- of the noise alone: runout free, everything else the nameplate says known exactly, no prior. What is singular here
  no tolerance can be blamed for: this data cannot tell it, from any rig of this kind;
- as fitted: every nuisance free within its prior. (Free without any prior, the amount of an unbalance is never
  determined: it is tied to the probe gains.)

Linear algebra at the optimum: it says nothing about valleys further away.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from rotorrig.identify.base_model import Parameters, Reals
from rotorrig.identify.extended_model import ExtendedParameters
from rotorrig.identify.identification import Direction
from rotorrig.identify.least_squares import Solution, inverse_information
from rotorrig.identify.uncertainty.settings import UNCERTAINTY


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinate:
    """One quantity sought, and how it is measured."""

    name: str
    unit: str
    reference: float  # SI: changes are in parts of it; the value itself if logarithmic, 1 rad for a phase
    logarithmic: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Weakness:
    """Relative changes that hardly show, the largest 1, and the combination of the same quantities known best."""

    names: tuple[str, ...]
    changes: Reals  # (name,)
    known: Reals  # (name,) weights, the largest 1
    known_sigma: float


class Identifiability:
    """The informations at the optimum of one fit."""

    def __init__(self, best: Solution, parameters: ExtendedParameters, *, phases: bool = True) -> None:
        """Marginalise what is not sought; without `phases` those of the unbalance are not."""
        base = parameters.base
        self.coordinates, step = _coordinates(best.p, base)
        if not phases:
            kept = [i for i, c in enumerate(self.coordinates) if c.name not in base.space.phases]
            self.coordinates, step = tuple(self.coordinates[i] for i in kept), step[:, kept]
        excess = np.sqrt(max(1.0, best.chi2 / best.dof))
        whole = best.jacobian @ step
        other = np.setdiff1d(np.arange(len(parameters)), np.r_[base.sought, base.unbalance])
        data = slice(0, len(best.jacobian) - len(parameters.priors))
        runout = np.r_[*parameters.runouts.values()]
        self.noise = _marginal(whole[data], best.jacobian[data][:, runout]) / excess
        self.fitted = _marginal(whole, best.jacobian[:, other]) / excess
        self._budget = dict(zip(self.names, _budget(best.jacobian, step, parameters), strict=True))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of what is sought, as those of the estimates."""
        return tuple(c.name for c in self.coordinates)

    def directions(self) -> tuple[Direction, ...]:
        """Return the singular directions as fitted, least known first."""
        sigma, vectors = _directions(self.fitted)
        of_noise = _standard_deviations(self.noise, vectors)
        return tuple(
            Direction(
                weights=dict(zip(self.names, map(float, vector), strict=True)),
                sigma=float(s),
                sigma_of_noise=float(n),
            )
            for vector, s, n in zip(vectors, sigma, of_noise, strict=True)
        )

    def budget(self) -> dict[str, dict[str, float]]:
        """Return the share that noise and every kind of prior have in each variance: {"u": {"noise": 0.1, ..}}."""
        return self._budget

    def correlation(self) -> Reals:
        """Return the correlations as fitted, (sought, sought)."""
        covariance = inverse_information(self.fitted)
        sigma = np.sqrt(np.diag(covariance))
        return covariance / np.outer(sigma, sigma)

    def combination(self, names: tuple[str, ...], root: Reals) -> tuple[Reals, float]:
        """Return the combination of `names` known best, the rest free: weights, the largest 1, and its sigma."""
        return _best_known(root, np.array([self.names.index(name) for name in names]))

    def sigma(self, name: str, root: Reals) -> float:
        """Return the standard deviation of one quantity, all others free."""
        return float(_standard_deviations(root, np.eye(len(self.names))[[self.names.index(name)]])[0])

    def undetermined(self, root: Reals) -> list[str]:
        """Return what would not be determined even if all else were known."""
        return [
            name
            for name, column in zip(self.names, root.T, strict=True)
            if np.linalg.norm(column) < 1 / UNCERTAINTY.determined
        ]

    def weaknesses(self, root: Reals, *, known: Collection[str] = ()) -> list[Weakness]:
        """Return the changes that `root`, `noise` or `fitted`, leaves undetermined, each in as few names as can be.

        Those in `known` are held.
        """
        names = [name for name in self.names if name not in known]
        if not names:
            return []
        root = root[:, [self.names.index(name) for name in names]]
        sigma, vectors = _directions(root)
        return [_weakness(names, change, root) for change in _sparse(vectors[sigma > UNCERTAINTY.determined])]


def _weakness(names: list[str], change: Reals, root: Reals) -> Weakness:
    largest = _largest(change)
    taking = np.flatnonzero(np.abs(change) >= UNCERTAINTY.takes_part * abs(largest))
    known, known_sigma = _best_known(root, taking)
    return Weakness(
        names=tuple(names[i] for i in taking),
        changes=change[taking] / largest,
        known=known,
        known_sigma=known_sigma,
    )


def _best_known(root: Reals, chosen: NDArray[np.intp]) -> tuple[Reals, float]:
    """Return the combination of the chosen columns known best, the rest free: weights, the largest 1, and its sigma."""
    rest = np.setdiff1d(np.arange(root.shape[1]), chosen)
    sigma, vectors = _directions(_marginal(root[:, chosen], root[:, rest]))
    largest = _largest(vectors[-1])
    return vectors[-1] / largest, float(sigma[-1] / abs(largest))


def _coordinates(p: Reals, parameters: Parameters) -> tuple[tuple[Coordinate, ...], Reals]:
    """Return what is sought, and the change of `p` per unit of each, (parameter, sought)."""
    space = parameters.space
    values = parameters.values(p)
    references, slopes = space.references(values), space.slopes(values)
    coordinates = [
        Coordinate(
            name=unknown.name,
            unit=unknown.unit,
            reference=float(references[i]),
            logarithmic=unknown.scale == "log",
        )
        for i, unknown in enumerate(space.unknowns)
    ]
    step = np.zeros((len(p), len(space) + 2 * len(space.planes)))
    step[parameters.sought, : len(space)] = np.diag(references / slopes)
    for i, (amount, u) in enumerate(zip(space.amounts, parameters.amounts(p).values(), strict=True)):
        row, column = parameters.unbalance.start + 2 * i, len(space) + 2 * i
        step[row : row + 2, column : column + 2] = [[u.real, -u.imag], [u.imag, u.real]]
        coordinates += [
            Coordinate(name=amount.name, unit=amount.unit, reference=abs(u), logarithmic=True),
            Coordinate(name=space.phases[i], unit="rad", reference=1.0, logarithmic=False),
        ]
    return tuple(coordinates), step


def _marginal(wanted: Reals, others: Reals) -> Reals:
    """Return the part of the columns `wanted` that no combination of the columns `others` can imitate."""
    return wanted - others @ np.linalg.lstsq(others, wanted, rcond=None)[0] if others.size else wanted


def _directions(root: Reals) -> tuple[Reals, Reals]:
    """Return standard deviations, largest first, and the orthonormal directions they belong to, one per row."""
    _, size, vectors = np.linalg.svd(root, full_matrices=False)
    return 1 / np.maximum(size[::-1], np.finfo(float).eps * size[0]), vectors[::-1]


def _standard_deviations(root: Reals, vectors: Reals) -> Reals:
    """Return the standard deviation along each of `vectors`, one per row."""
    sigma, directions = _directions(root)
    return np.linalg.norm((vectors @ directions.T) * sigma, axis=1)


def _largest(vector: Reals) -> float:
    """Return the entry of largest magnitude, the first of several that hardly differ."""
    size = np.abs(vector)
    return float(vector[np.argmax(size > 0.99 * size.max())])


def _sparse(vectors: Reals) -> Reals:
    """Return other vectors that span the same, each with a one where the others have a zero.

    Singular vectors of like singular values are mixed at random: two quantities that are each undetermined would look
    tied. Reduced to echelon form, on the pivots of a QR factorisation, they come apart.
    """
    if len(vectors) == 0:
        return vectors
    _, pivots = linalg.qr(vectors, mode="r", pivoting=True)
    return np.asarray(np.linalg.solve(vectors[:, pivots[: len(vectors)]], vectors), dtype=float)


def _budget(jacobian: Reals, step: Reals, parameters: ExtendedParameters) -> list[dict[str, float]]:
    """Return per sought quantity the shares of its variance: the estimate is linear in every figure and prior."""
    reading = step.T / np.sum(step**2, axis=0)[:, None]  # of p, its columns are orthogonal
    influence = (reading @ inverse_information(jacobian) @ jacobian.T) ** 2  # (sought, row)
    figures = len(jacobian) - len(parameters.priors)
    kinds = ["noise"] * figures + [_kind(parameters.names[i]) for i in parameters.priors]
    names = list(dict.fromkeys(kinds))
    member = np.array([[kind == name for name in names] for kind in kinds], dtype=float)
    shares = influence @ member / influence.sum(axis=1)[:, None]
    return [dict(zip(names, map(float, row), strict=True)) for row in shares]


_KINDS = {
    "gain": "probe gain",
    "angle": "probe angle",
    "bearing": "other bearings",
    "position": "positions",
    "hub": "hubs",
    "tilt": "tilt stiffness",
    "runout": "runout",
    "hum": "line hum",
    "curvature": "probe linearity",
    "internal_damping:": "internal damping",
}


def _kind(nuisance: str) -> str:
    """Return what a nuisance is one of: "gain 1x" of the probe gains."""
    return _KINDS.get(nuisance.split()[0], nuisance)
