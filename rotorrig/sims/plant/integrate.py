"""Time integration of the shaft's motion: Newmark's average acceleration, the linear part factored once.

Unconditionally stable and without numerical damping; a mode of frequency w has its period too long by (w h)^2 / 12
(Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67). Gyroscopic and rotating-damping forces and the force laws depend on
the end of the step and are iterated to `TOLERANCE`.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit, types
from numba.typed import List
from numpy.typing import NDArray

from rotorrig.rig import DataError
from rotorrig.sims.plant.deviations import REFERENCE
from rotorrig.sims.plant.force_laws import LAW, Force, Motion, Turn
from rotorrig.sims.plant.shaft import Rotor

TOLERANCE = 1e-4  # of the largest acceleration; 1e-9 moves a probe by 1e-11 m in 10 s at the critical speed
ITERATIONS = 50  # 3 on a healthy shaft


class _Matrices(NamedTuple):
    """Matrices of a step; all stored transposed, so that a product runs down contiguous columns."""

    inverse: NDArray[np.float64]  # (M + h/2 C + h^2/4 K)^-1
    C: NDArray[np.float64]
    K: NDArray[np.float64]
    G: NDArray[np.float64]
    D: NDArray[np.float64]
    coupled: bool  # inverse, C and K have something from one plane to the other


class _Loads(NamedTuple):
    """Driving loads: their coordinates in the x plane, and their constants."""

    constant: NDArray[np.float64]  # (2n,) N, weight
    unbalance_at: NDArray[np.intp]  # (disk,)
    unbalance: NDArray[np.float64]  # (disk, 2) kg m and signed angle
    random_at: NDArray[np.intp]  # (bearing,)
    damped_at: NDArray[np.intp]  # (damper,)
    damping: NDArray[np.float64]  # (damper, 2) N s/m per rad/s, in x and y


class _Forces(NamedTuple):
    """Force laws: the coordinates each acts on, its rest position and its constants; rows filled up with zeros."""

    at: NDArray[np.intp]  # (force, coordinate)
    weight: NDArray[np.float64]  # (force, coordinate)
    rest: NDArray[np.float64]  # (force, 2) taken from its x and y
    constants: NDArray[np.float64]  # (force, constant)


class ShaftMotion:
    """Position, velocity and acceleration of a rotor between steps; it begins at rest under its weight."""

    def __init__(
        self,
        rotor: Rotor,
        *,
        step: float,
        gravity: tuple[float, float] = (0.0, 0.0),
        unbalances: tuple[tuple[float, float, float], ...] = (),
        random_at: tuple[float, ...] = (),
        damping: tuple[tuple[float, float, float], ...] = (),
        forces: tuple[Force, ...] = (),
        watched: tuple[float, ...] = (),
    ) -> None:
        """Set up forces and outputs; all places in m must be coordinates of `rotor`, `step` in s.

        `unbalances` are (place, kg m, rad in signed shaft angle), `random_at` the places of the forces handed to
        `run`, `damping` (place, N s/m per rad/s in x, in y) what speed adds to it above
        `deviations.REFERENCE` and takes off below, `watched` the places whose deflection it returns.
        """
        n, h = rotor.n, step
        self._h = h
        A = rotor.M + h / 2 * rotor.C + h * h / 4 * rotor.K
        parts = (np.linalg.inv(A), rotor.C, rotor.K, rotor.G, rotor.D)
        coupled = any(part[:n, n:].any() or part[n:, :n].any() for part in parts[:3])
        inverse, C, K, G, D = (np.ascontiguousarray(part.T) for part in parts)
        self._matrices = _Matrices(inverse, C, K, G, D, coupled)
        self._laws = List.empty_list(types.FunctionType(LAW))
        for force in forces:
            self._laws.append(force.law)
        self._loads = _Loads(
            constant=np.concatenate([rotor.weight * g for g in gravity]),
            unbalance_at=_indices(rotor, tuple(u[0] for u in unbalances)),
            unbalance=np.array([u[1:] for u in unbalances]).reshape(-1, 2),
            random_at=_indices(rotor, random_at),
            damped_at=_indices(rotor, tuple(d[0] for d in damping)),
            damping=np.array([d[1:] for d in damping]).reshape(-1, 2),
        )
        self._watched = _indices(rotor, watched)
        self._state = np.zeros((3, 2 * n))
        self._state[0] = rotor.static_sag(gravity)
        self._forces = _place_forces(rotor, forces, self._state[0])
        self._memory = np.zeros((2, len(forces), max((f.memory for f in forces), default=0)))
        self._steps = 0

    @property
    def state(self) -> NDArray[np.float64]:
        """q, q', q'' (3, 2n); may be written to, for a release from a deflected shape."""
        return self._state

    def run(
        self,
        angle: NDArray[np.float64],
        omega: NDArray[np.float64],
        alpha: NDArray[np.float64],
        random: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Step through signed shaft `angle`, speed and acceleration (step,) and `random` forces (step, place, 2) [N].

        Returns the watched deflections (step, place, 2) [m], x and y. Raises DataError if a fault is too stiff for
        the step to be solved.
        """
        if random is None:
            random = np.zeros((len(angle), len(self._loads.random_at), 2))
        deflections = np.empty((len(angle), len(self._watched), 2))
        t = self._h * (self._steps + 1 + np.arange(len(angle)))
        self._steps += len(angle)
        turning = np.stack([t, angle, omega, alpha], axis=1)
        stuck = _step_through(
            self._state,
            self._memory,
            self._h,
            self._matrices,
            self._loads,
            self._forces,
            self._laws,
            turning,
            random,
            self._watched,
            deflections,
        )
        if stuck >= 0:
            raise DataError(
                f"the simulated shaft's forces at {abs(omega[stuck]):.1f} rad/s did not settle in {ITERATIONS} "
                f"iterations of a {self._h * 1e6:.0f} us step, want a softer fault or a higher sample rate"
            )
        return deflections


def _indices(rotor: Rotor, places: tuple[float, ...]) -> NDArray[np.intp]:
    return np.array([rotor.station(p) for p in places], dtype=np.intp)


def _place_forces(rotor: Rotor, forces: tuple[Force, ...], q0: NDArray[np.float64]) -> _Forces:
    at = _table([tuple(rotor.coordinate(c) for c, _ in f.on) for f in forces]).astype(np.intp)
    weight = _table([tuple(w for _, w in f.on) for f in forces])
    centred = np.array([f.from_rest for f in forces], dtype=float)
    rest = np.stack([np.sum(weight * plane[at], axis=1) * centred for plane in q0.reshape(2, -1)], axis=1)
    return _Forces(at=at, weight=weight, rest=rest, constants=_table([f.constants for f in forces]))


def _table(rows: list[tuple[float, ...]]) -> NDArray[np.float64]:
    """Return rows of unequal length as one array, filled up with zeros."""
    table = np.zeros((len(rows), max(map(len, rows), default=0)))
    for line, row in zip(table, rows, strict=True):
        line[: len(row)] = row
    return table


@njit(cache=True)
def _add_product(columns: NDArray, x: NDArray, factor: float, coupled: bool, out: NDArray) -> None:
    """Add factor * A x to `out`, A given by its columns; the order of sums is fixed, so runs are repeatable.

    Unless `coupled`, A has nothing from one plane to the other, which is half of the work.
    """
    n = len(out) // 2
    for j in range(len(x)):
        scaled = factor * x[j]
        first = 0 if coupled or j < n else n
        for i in range(first, 2 * n if coupled else first + n):
            out[i] += columns[j, i] * scaled


@njit(cache=True)
def _add_driving(loads: _Loads, turning: NDArray, random: NDArray, f: NDArray) -> None:
    """Add the forces known before the step: unbalance, Re[(W^2 - j a) U e^{j psi} (1, -j)], and random ones."""
    n = len(f) // 2
    _, angle, omega, alpha = turning
    for k in range(len(loads.unbalance_at)):
        at, U, psi = loads.unbalance_at[k], loads.unbalance[k, 0], angle + loads.unbalance[k, 1]
        f[at] += U * (omega * omega * math.cos(psi) + alpha * math.sin(psi))
        f[at + n] += U * (omega * omega * math.sin(psi) - alpha * math.cos(psi))
    for k in range(len(loads.random_at)):
        f[loads.random_at[k]] += random[k, 0]
        f[loads.random_at[k] + n] += random[k, 1]


@njit(cache=True)
def _add_across(columns: NDArray, x: NDArray, factor: float, out: NDArray) -> None:
    """Add -factor [[0, A], [-A, 0]] x to `out`: the coupling of the two planes by rotation."""
    n = len(out) // 2
    for j in range(n):
        from_x, from_y = factor * x[j], factor * x[j + n]
        for i in range(n):
            out[i] -= columns[j, i] * from_y
            out[i + n] += columns[j, i] * from_x


@njit(cache=True)
def _add_forces(forces: _Forces, laws: List, turn: Turn, q: NDArray, v: NDArray, memory: NDArray, f: NDArray) -> None:
    n = len(f) // 2
    for k in range(len(laws)):
        x, y, vx, vy = -forces.rest[k, 0], -forces.rest[k, 1], 0.0, 0.0
        for i in range(forces.at.shape[1]):
            at, weight = forces.at[k, i], forces.weight[k, i]
            x += weight * q[at]
            y += weight * q[at + n]
            vx += weight * v[at]
            vy += weight * v[at + n]
        fx, fy = laws[k](turn, Motion(x, y, vx, vy), forces.constants[k], memory[0, k], memory[1, k])
        for i in range(forces.at.shape[1]):
            at, weight = forces.at[k, i], forces.weight[k, i]
            f[at] += weight * fx
            f[at + n] += weight * fy


@njit(cache=True)
def _end_of_step(q0: NDArray, v0: NDArray, a: NDArray, h: float, q: NDArray, v: NDArray) -> None:
    for i in range(len(a)):
        q[i] = q0[i] + (h * h / 4.0) * a[i]
        v[i] = v0[i] + (h / 2.0) * a[i]


@njit(cache=True)
def _add_damping(loads: _Loads, omega: float, v0: NDArray, a: NDArray, h: float, f: NDArray) -> None:
    """Add what speed does to the bearings' damping, at the velocity of the end of the step."""
    n = len(f) // 2
    for k in range(len(loads.damped_at)):
        at = loads.damped_at[k]
        over = abs(omega) - REFERENCE
        f[at] -= over * loads.damping[k, 0] * (v0[at] + h / 2.0 * a[at])
        f[at + n] -= over * loads.damping[k, 1] * (v0[at + n] + h / 2.0 * a[at + n])


@njit(cache=True)
def _has_converged(new: NDArray, a: NDArray) -> bool:
    change, largest = 0.0, 0.0
    for i in range(len(a)):
        change = max(change, abs(new[i] - a[i]))
        largest = max(largest, abs(new[i]))
    return change <= TOLERANCE * largest


@njit(cache=True)
def _step_through(
    state: NDArray,
    memory: NDArray,
    h: float,
    m: _Matrices,
    loads: _Loads,
    forces: _Forces,
    laws: List,
    turning: NDArray,
    random: NDArray,
    watched: NDArray,
    deflections: NDArray,
) -> int:
    """Step through `turning`, filling `deflections`; return the first step that did not settle, or -1.

    Loops stand where array expressions would: their temporaries took half of the time.
    """
    q, v, a = state[0], state[1], state[2]
    n = len(q) // 2
    size = len(q)
    q0, v0, mixed = np.empty(size), np.empty(size), np.empty(size)
    known, f, new = np.empty(size), np.empty(size), np.empty(size)
    E = np.empty((n, n))
    for i in range(len(turning)):
        t, angle, omega, alpha = turning[i, 0], turning[i, 1], turning[i, 2], turning[i, 3]
        turn = Turn(t, angle, omega, alpha, h)
        for j in range(size):  # what the step's own acceleration does not change
            v0[j] = v[j] + (h / 2.0) * a[j]
            q0[j] = q[j] + h * v[j] + (h * h / 4.0) * a[j]
            mixed[j] = omega * v0[j] + alpha * q0[j]
            known[j] = loads.constant[j]
        _add_driving(loads, turning[i], random[i], known)
        _add_product(m.C, v0, -1.0, m.coupled, known)
        _add_product(m.K, q0, -1.0, m.coupled, known)
        _add_across(m.G, mixed, 1.0, known)
        _add_across(m.D, q0, omega, known)
        by_g, by_d = h / 2 * omega + h * h / 4 * alpha, h * h / 4 * omega
        for j in range(n):  # the same two terms per acceleration at the end of the step
            for k in range(n):
                E[j, k] = by_g * m.G[j, k] + by_d * m.D[j, k]
        for _ in range(ITERATIONS):
            for j in range(size):
                f[j] = known[j]
                new[j] = 0.0
            _add_across(E, a, 1.0, f)
            _add_damping(loads, omega, v0, a, h, f)
            if len(laws):
                _end_of_step(q0, v0, a, h, q, v)
                _add_forces(forces, laws, turn, q, v, memory, f)
            _add_product(m.inverse, f, 1.0, m.coupled, new)
            converged = _has_converged(new, a)
            for j in range(size):
                a[j] = new[j]
            if converged:
                break
        else:
            return i
        _end_of_step(q0, v0, a, h, q, v)
        memory[0] = memory[1]
        for k in range(len(watched)):
            deflections[i, k, 0], deflections[i, k, 1] = q[watched[k]], q[watched[k] + n]
    return -1
