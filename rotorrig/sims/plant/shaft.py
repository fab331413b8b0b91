"""The plant's own rotor: Euler-Bernoulli beam elements, reduced to the places where something acts or is seen.

Shear is neglected and the mesh follows the stations, so that this theory differs from the Timoshenko model a fit
uses. Both planes share one set of matrices in (x, dx/dz) and (y, dy/dz); the reduction keeps the deflection at every
station and the slope at every disk as coordinates, which forces may act on, plus a few fixed-interface modes
(Craig and Bampton, AIAA Journal 6 (1968) 1313).
"""

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.deviations import REFERENCE
from rotorrig.sims.plant.force_laws import Coordinate, Deflection, Slope
from rotorrig.sims.plant.places import SAME_PLACE
from rotorrig.sims.plant.truth import Truth

LONGEST_ELEMENT = 0.031  # m; the first critical speed is converged to 1e-8
FIXED_MODES = 4  # fixed-interface modes kept; the first critical speed is then 3e-6 too high
MATERIAL_DAMPING = 3e-6  # s, stress = E (strain + this * strain rate): steel, damping ratio 0.03 % at 233 rad/s


@dataclass(frozen=True, slots=True, kw_only=True)
class Rotor:
    """Reduced matrices: n coordinates in each plane, the x plane's n first and the y plane's n after them.

    With s the signed speed, M q'' + C q' + s G2 q' + s' G2 q + s H2 q + K q = f, where G2 = [[0, G], [-G, 0]] is
    gyroscopic and H2 = [[0, D], [-D, 0]] the part of the material damping that turns with the shaft.
    """

    M: NDArray[np.float64]  # (2n, 2n) kg, kg m^2
    C: NDArray[np.float64]  # (2n, 2n) bearings and material damping
    K: NDArray[np.float64]  # (2n, 2n) bearings and shaft
    G: NDArray[np.float64]  # (n, n) polar inertia, one plane
    D: NDArray[np.float64]  # (n, n) material damping, one plane
    shaft: NDArray[np.float64]  # (n, n) stiffness of the shaft alone, one plane
    weight: NDArray[np.float64]  # (n,) force of a unit acceleration of the ground, kg
    stations: tuple[float, ...]  # m, place of coordinate i for i < len(stations)
    slopes: tuple[float, ...]  # m, places of the coordinates that follow

    @property
    def n(self) -> int:
        """Coordinates per plane."""
        return len(self.weight)

    def station(self, position: float) -> int:
        """Return the coordinate of the deflection at `position` [m], which must be a station."""
        nearest = _nearest(self.stations, position)
        assert abs(self.stations[nearest] - position) <= SAME_PLACE, f"no station at {position} m"
        return nearest

    def slope(self, position: float) -> int:
        """Return the coordinate of the slope at `position` [m], which must be kept."""
        nearest = _nearest(self.slopes, position)
        assert abs(self.slopes[nearest] - position) <= SAME_PLACE, f"no slope kept at {position} m"
        return len(self.stations) + nearest

    def coordinate(self, of: Coordinate) -> int:
        """Return the coordinate of a deflection or slope, which must be kept."""
        return self.station(of.position) if isinstance(of, Deflection) else self.slope(of.position)

    def with_coordinate(self) -> "Rotor":
        """Return a rotor with one more coordinate in each plane, behind the others, yet without mass or spring."""
        n = self.n
        old = np.r_[0:n, n + 1 : 2 * n + 1]

        def both(A: NDArray[np.float64]) -> NDArray[np.float64]:
            wide = np.zeros((2 * n + 2, 2 * n + 2))
            wide[np.ix_(old, old)] = A
            return wide

        def one(A: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.pad(A, (0, 1))

        return replace(
            self,
            M=both(self.M),
            C=both(self.C),
            K=both(self.K),
            G=one(self.G),
            D=one(self.D),
            shaft=one(self.shaft),
            weight=one(self.weight),
        )

    def static_sag(self, gravity: tuple[float, float]) -> NDArray[np.float64]:
        """Return q (2n,) at rest under `gravity`, the acceleration (x, y) in m/s^2."""
        return np.linalg.solve(self.K, np.concatenate([self.weight * g for g in gravity]))

    def critical_speeds(self, count: int = 2) -> NDArray[np.float64]:
        """Return the lowest undamped synchronous critical speeds [rad/s], in both senses of whirl.

        With q = Re(Q e^{j w t}) at speed w, K Q = w^2 (M - j G2) Q; the matrix on the right is Hermitian.
        """
        n = self.n
        gyro = np.zeros((2 * n, 2 * n), complex)
        gyro[:n, n:], gyro[n:, :n] = 1j * self.G, -1j * self.G
        symmetric = (self.K + self.K.T) / 2
        inverse_squares = linalg.eigh(self.M - gyro, symmetric, eigvals_only=True)[::-1][:count]
        return 1.0 / np.sqrt(inverse_squares)


def build(rig: RigConfig, truth: Truth, *, extra: Iterable[Coordinate] = ()) -> Rotor:
    """Return the rotor of `rig` with the deviations of `truth`; `extra` coordinates are kept too."""
    extra = tuple(extra)
    disks = [d.position for d in rig.disks]
    places = [0.0, *disks, *(b.position for b in rig.bearings), *(p.position for p in rig.probes)]
    stations = _merge([*places, *(c.position for c in extra if isinstance(c, Deflection))])
    tilting = [b.position for b, k in zip(rig.bearings, truth.geometry.tilt_stiffnesses, strict=False) if k]
    slopes = _merge([*disks, *tilting, *(c.position for c in extra if isinstance(c, Slope))])
    z = _mesh([*stations, *slopes, *(tube.start for tube in rig.shaft.tubes)], rig.shaft.length)
    M, G, Ks = _free_rotor(rig, truth, z)
    kept = [2 * _nearest(z, s) for s in stations] + [2 * _nearest(z, s) + 1 for s in slopes]
    T = _craig_bampton(M, Ks, kept)
    translation = np.zeros(len(M))
    translation[::2] = 1.0
    M_r, G_r, K_r, weight = T.T @ M @ T, T.T @ G @ T, T.T @ Ks @ T, T.T @ (M @ translation)
    D = MATERIAL_DAMPING * K_r
    C_b, K_b = _bearings(truth, rig, stations, len(weight))
    springs = _more_springs(truth, rig, stations, slopes, len(weight))
    K_b += np.diag(np.tile(springs, 2))
    C_b += np.diag(np.tile(_coupling_damping(truth, stations, len(weight)), 2))
    return Rotor(
        M=linalg.block_diag(M_r, M_r),
        C=linalg.block_diag(D, D) + C_b,
        K=linalg.block_diag(K_r, K_r) + K_b,
        G=G_r,
        D=D,
        shaft=K_r,
        weight=weight,
        stations=tuple(stations),
        slopes=tuple(slopes),
    )


def _merge(places: list[float]) -> list[float]:
    """Return `places` sorted, those closer than `SAME_PLACE` once."""
    ordered = sorted(places)
    return ordered[:1] + [b for a, b in itertools.pairwise(ordered) if b - a > SAME_PLACE]


def _mesh(places: list[float], length: float) -> NDArray[np.float64]:
    """Return node places (node,) [m]: every one of `places`, both ends, and equal elements in between."""
    ends = _merge([0.0, *places, length])
    pieces = [
        np.linspace(a, b, int(np.ceil((b - a) / LONGEST_ELEMENT)), endpoint=False) for a, b in itertools.pairwise(ends)
    ]
    return np.concatenate([*pieces, ends[-1:]])


def _nearest(z: ArrayLike, place: float) -> int:
    return int(np.argmin(np.abs(np.asarray(z) - place)))


def _free_rotor(
    rig: RigConfig, truth: Truth, z: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return mass, polar inertia and stiffness of shaft and disks in one plane, (2 node, 2 node), bearings absent."""
    M, G, K = (np.zeros((2 * len(z), 2 * len(z))) for _ in range(3))
    for i, length in enumerate(np.diff(z)):
        here = slice(2 * i, 2 * i + 4)
        tube = next(t for t in reversed(rig.shaft.tubes) if t.start < z[i] + length / 2)
        area = np.pi / 4 * (tube.diameter**2 - tube.inner_diameter**2)
        second_moment = np.pi / 64 * (tube.diameter**4 - tube.inner_diameter**4)
        density = tube.density * truth.density_factor
        EI = tube.youngs_modulus * truth.modulus_factor * second_moment
        rotary = density * second_moment * rotary_inertia(length)
        M[here, here] += density * area * translational_inertia(length) + rotary
        G[here, here] += 2.0 * rotary  # a thin slice's polar inertia is twice its diametral one
        K[here, here] += EI * bending_stiffness(length)
    for disk, factor in zip(rig.disks, truth.disk_mass_factors, strict=True):
        x = 2 * _nearest(z, disk.position)
        M[x, x] += disk.mass * factor
        M[x + 1, x + 1] += disk.transverse_inertia * factor
        G[x + 1, x + 1] += disk.polar_inertia * factor
    return M, G, K


def bending_stiffness(length: float) -> NDArray[np.float64]:
    """Return an element's stiffness (4, 4) per unit EI in (w, w', w, w'), from cubic Hermite shapes, without shear.

    Przemieniecki, Theory of Matrix Structural Analysis (1968), sec. 5.6 with the shear parameter zero.
    """
    a = length
    return (
        np.array(
            [
                [12.0, 6 * a, -12.0, 6 * a],
                [6 * a, 4 * a * a, -6 * a, 2 * a * a],
                [-12.0, -6 * a, 12.0, -6 * a],
                [6 * a, 2 * a * a, -6 * a, 4 * a * a],
            ]
        )
        / a**3
    )


def translational_inertia(length: float) -> NDArray[np.float64]:
    """Return an element's consistent mass (4, 4) per unit mass per length. Przemieniecki (1968), sec. 11.4."""
    a = length
    return (a / 420.0) * np.array(
        [
            [156.0, 22 * a, 54.0, -13 * a],
            [22 * a, 4 * a * a, 13 * a, -3 * a * a],
            [54.0, 13 * a, 156.0, -22 * a],
            [-13 * a, -3 * a * a, -22 * a, 4 * a * a],
        ]
    )


def rotary_inertia(length: float) -> NDArray[np.float64]:
    """Return an element's rotary (Rayleigh) inertia (4, 4) per unit rho I. Przemieniecki (1968), sec. 11.4."""
    a = length
    return np.array(
        [
            [36.0, 3 * a, -36.0, 3 * a],
            [3 * a, 4 * a * a, -3 * a, -a * a],
            [-36.0, -3 * a, 36.0, -3 * a],
            [3 * a, -a * a, -3 * a, 4 * a * a],
        ]
    ) / (30.0 * a)


def _craig_bampton(M: NDArray[np.float64], K: NDArray[np.float64], kept: list[int]) -> NDArray[np.float64]:
    """Return the basis T (full, reduced): static shapes of the `kept` coordinates, then fixed-interface modes."""
    inner = np.setdiff1d(np.arange(len(M)), kept)
    inside, across = np.ix_(inner, inner), np.ix_(inner, np.array(kept))
    lowest = (0, min(FIXED_MODES, len(inner)) - 1)
    _, modes = linalg.eigh(K[inside], M[inside], subset_by_index=lowest)
    T = np.zeros((len(M), len(kept) + modes.shape[1]))
    T[kept, np.arange(len(kept))] = 1.0
    T[inner, : len(kept)] = -np.linalg.solve(K[inside], K[across])
    T[inner, len(kept) :] = modes
    return T


def _bearings(
    truth: Truth, rig: RigConfig, stations: list[float], n: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return damping and stiffness of all bearings, (2n, 2n) each."""
    C, K = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
    for plate, b in zip(rig.bearings, truth.bearings, strict=True):
        x = _nearest(stations, plate.position)
        here = np.ix_([x, x + n], [x, x + n])
        K[here] += [[b.kxx, b.kxy], [b.kyx, b.kyy]]
        C[here] += [[b.cxx, b.cxy], [b.cyx, b.cyy]]
    return C, K


def _coupling_damping(truth: Truth, stations: list[float], n: int) -> NDArray[np.float64]:
    """Return the dashpots (n,) to the ground of a coupling whose rubber loses a share of what it is pushed with."""
    damping = np.zeros(n)
    healthy = truth.unmodelled
    damping[_nearest(stations, 0.0)] = healthy.coupling_loss * healthy.coupling_stiffness / REFERENCE
    return damping


def _more_springs(
    truth: Truth, rig: RigConfig, stations: list[float], slopes: list[float], n: int
) -> NDArray[np.float64]:
    """Return the springs (n,) to the ground that no nameplate speaks of: the coupling's, and bearings' against tilt."""
    springs = np.zeros(n)
    springs[_nearest(stations, 0.0)] = truth.unmodelled.coupling_stiffness
    for bearing, k in zip(rig.bearings, truth.geometry.tilt_stiffnesses, strict=False):
        if k:
            springs[len(stations) + _nearest(slopes, bearing.position)] += k
    return springs
