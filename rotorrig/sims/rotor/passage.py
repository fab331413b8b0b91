"""The few modes a moving speed passes near, and their amplitudes from turn to turn.

With q = Re(A e^{j theta}) and y the state (A, its velocity), y' = (S(Omega) - j Omega) y + b (Omega^2 - j alpha),
where S is the state matrix. Its invariant parts are treated apart:

- passed modes, whose poles lie near j Omega: y = Phi(Omega) a with
  a' = (L - j Omega - alpha T) a + g (Omega^2 - j alpha), stepped by an exponential integrator;
- the others, which follow at once: an error of about 2 alpha / (Omega d) of their part for a pole at distance d.

Phi spans the passed modes together and is held to a fixed gauge, so that nothing jumps where two of them, x and y of
one bending shape, cross or coincide. Everything is smooth in Omega: a polynomial through a few speeds.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.rotor.assembly import RotorModel, hysteretic, matrices
from rotorrig.sims.rotor.loads import unbalance_pattern
from rotorrig.sims.rotor.modes import state_matrix
from rotorrig.sims.rotor.timeline import Turns

Complex = NDArray[np.complex128]

MOST_PASSED = 12  # poles
FAR = 0.3  # of the top speed: a pole at least so far from every j Omega may be left to follow at once
ACCURACY = 1e-5  # of the polynomials in Omega, as a part of the others' response
FEWEST, MOST = 5, 13  # speeds the polynomials go through; odd, so that the centre is one of them


@dataclass(frozen=True, slots=True, kw_only=True)
class Passage:
    """Polynomials in x = (Omega - centre) / half, power first, of all that `march` and the sum over modes need."""

    centre: float  # rad/s
    half: float  # rad/s
    L: Complex  # (power, mode, mode) 1/s
    T: Complex  # (power, mode, mode) s
    g: Complex  # (power, mode)
    shape: Complex  # (power, mode, probe)
    others: Complex  # (power, probe) m s^2

    def powers(self, omega: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return 1, x, x^2.. at the speeds, (..., power)."""
        x = (omega - self.centre) / self.half
        return np.vander(x.ravel(), len(self.g), increasing=True).reshape(*x.shape, -1)


def passage(model: RotorModel, *, slowest: float, fastest: float, unbalance: Mapping[str, complex]) -> Passage:
    """Return the passed modes and the others' response for speeds from `slowest` to `fastest` [rad/s]."""
    centre, half = (slowest + fastest) / 2, max((fastest - slowest) / 2, 1e-3 * fastest)
    for bearing in model.bearings:
        if not bearing.constant:
            raise ConfigError(
                f"bearing '{bearing.name}': its coefficients depend on speed, want constants while the speed moves"
            )
    system = matrices(model)
    load = np.append(np.zeros(model.dof), np.linalg.solve(system.M, unbalance_pattern(model, unbalance)))
    at_rest = state_matrix(system, 0.0)
    gyroscopic = state_matrix(system, 1.0) - at_rest  # S(Omega) is linear in Omega
    if model.structural_damping:  # A e^{j theta} turns forwards, so K + j H is its stiffness at every speed
        at_rest = state_matrix(system._replace(K=system.K + 1j * hysteretic(model)), 0.0)

    middle = _poles(at_rest + centre * gyroscopic, slowest, fastest)
    count = _passed(middle.distance, far=FAR * fastest)
    gauge = np.linalg.qr(middle.vectors[:, :count])[0].conj().T
    x = _points(middle.values[count:] / 1j, centre, half)
    pieces = []
    for omega in centre + half * x:
        poles = middle if omega == centre else _poles(at_rest + omega * gyroscopic, slowest, fastest)
        pieces.append(_piece(poles, omega, count, gauge, load, model.probes))
    right, left, L, g, others = (np.array(part) for part in zip(*pieces, strict=True))

    fit = np.linalg.inv(np.vander(x, increasing=True))  # (power, speed): values to coefficients
    slope = np.vander(x, increasing=True)[:, :-1] * np.arange(1, len(x)) / half  # d/dOmega of x^1, x^2..
    turning = np.tensordot(slope @ fit[1:], right, 1)  # dPhi/dOmega at the speeds
    return Passage(
        centre=centre,
        half=half,
        L=np.tensordot(fit, L, 1),
        T=np.tensordot(fit, left @ turning, 1),
        g=np.tensordot(fit, g, 1),
        shape=np.tensordot(fit, right[:, : model.dof].transpose(0, 2, 1) @ model.probes.T, 1),
        others=np.tensordot(fit, others, 1),
    )


def march(modes: Passage, turns: Turns) -> tuple[Complex, Complex]:
    """Return the passed amplitudes a and their rates a' at every whole turn, (turn, mode) each; steady at the first.

    Each step is exact for a constant L - alpha T, a quadratic phase and a force quadratic in time.
    """
    operator = _operator(modes, turns.omega, turns.alpha)
    force = _force(modes, turns.omega, turns.alpha)
    h = np.diff(turns.t)
    # Within a step Omega moves on from omega_mid: that phase, known from the pulses, is put into the force.
    halfway = np.exp(1j * (turns.theta_mid - turns.omega_mid * h / 2))
    end = np.exp(1j * (2 * np.pi - turns.omega_mid * h))
    forces = np.stack(
        [
            force[:-1],
            _force(modes, turns.omega_mid, turns.alpha_mid) * halfway[:, None],
            force[1:] * end[:, None],
        ],
        axis=1,
    )
    steady = np.linalg.solve(operator[0], -force[0])
    a = _steps(_operator(modes, turns.omega_mid, turns.alpha_mid), h, forces, end.conj(), steady)
    return a, np.einsum("tij,tj->ti", operator, a) + force


class _Poles(NamedTuple):
    """The eigenvalues of S, nearest the passed speeds first."""

    values: Complex  # (pole,) rad/s
    vectors: Complex  # (2 dof, pole)
    distance: NDArray[np.float64]  # (pole,) rad/s from the nearest j Omega of the timeline


def _poles(S: NDArray[np.float64], slowest: float, fastest: float) -> _Poles:
    values, vectors = np.linalg.eig(S)
    distance = np.abs(values - 1j * np.clip(values.imag, slowest, fastest))
    nearest = np.argsort(distance)
    return _Poles(values[nearest].astype(complex), vectors[:, nearest].astype(complex), distance[nearest])


def _passed(distance: NDArray[np.float64], *, far: float) -> int:
    """Return how many poles count as passed: those before the widest gap that leaves only far ones."""
    most = min(MOST_PASSED, len(distance) - 1)
    gap = distance[1 : most + 1] / distance[:most]
    enough = distance[1 : most + 1] >= far
    return int(np.argmax(np.where(enough, gap, 0.0))) + 1 if enough.any() else most


def _points(others: Complex, centre: float, half: float) -> NDArray[np.float64]:
    """Return Chebyshev points in [-1, 1], enough for a function with poles at Omega = `others`.

    The error falls as rho^-n, rho the size of the ellipse through the nearest pole (Trefethen, Approximation Theory
    and Approximation Practice, 2013, ch. 8).
    """
    x = (others - centre) / half
    root = np.sqrt(x**2 - 1)
    rho = float(np.maximum(abs(x + root), abs(x - root)).min())
    wanted = math.log(1 / ACCURACY) / math.log(rho)
    count = min(max(math.ceil(wanted), FEWEST), MOST)
    count += 1 - count % 2
    return np.sin(np.pi * (np.arange(count) - count // 2) / count)  # exactly 0 in the middle


def _piece(
    poles: _Poles, omega: float, count: int, gauge: Complex, load: NDArray, probes: NDArray[np.float64]
) -> tuple[Complex, ...]:
    """Return Phi, its left inverse, L, g and the others' response at one speed."""
    passed = poles.vectors[:, :count]
    dual = np.linalg.inv(poles.vectors)
    W = gauge @ passed  # Phi = passed W^-1, so that gauge Phi = 1 at every speed
    back = np.linalg.inv(W)
    others = (dual[count:] @ load) / (1j * omega - poles.values[count:])
    left = W @ dual[:count]
    return (
        passed @ back,
        left,
        (W * poles.values[:count]) @ back,
        left @ load,
        probes @ (poles.vectors[: probes.shape[1], count:] @ others),
    )


def _operator(modes: Passage, omega: NDArray[np.float64], alpha: NDArray[np.float64]) -> Complex:
    """Return L - j Omega - alpha T at the speeds, (speed, mode, mode)."""
    power = modes.powers(omega)
    still = np.tensordot(power, modes.L, 1) - alpha[:, None, None] * np.tensordot(power, modes.T, 1)
    return still - 1j * omega[:, None, None] * np.eye(modes.g.shape[1])


def _force(modes: Passage, omega: NDArray[np.float64], alpha: NDArray[np.float64]) -> Complex:
    """Return g (Omega^2 - j alpha) at the speeds, (speed, mode)."""
    return (omega**2 - 1j * alpha)[:, None] * (modes.powers(omega) @ modes.g)


@njit(cache=True)
def _steps(L: Complex, h: NDArray[np.float64], forces: Complex, turned: Complex, start: Complex) -> Complex:
    """Integrate a' = L a + f over steps of length h, f through its values at the start, the middle and the end.

    With f = p0 + p1 s + p2 s^2 the solution is c0 + c1 s + c2 s^2 + e^{L s} (a - c0), then turned to the next frame.
    """
    size = len(start)
    a = np.empty((len(h) + 1, size), dtype=np.complex128)
    a[0] = start
    flow, inverse, work, power = np.empty((4, size, size), dtype=np.complex128)
    c0, c1, c2, right = np.empty((4, size), dtype=np.complex128)
    for k in range(len(h)):
        _invert(L[k], inverse, work)
        _exponential(L[k], h[k], flow, work, power)
        p0, middle, last = forces[k]
        for i in range(size):
            right[i] = -2 * (p0[i] - 2 * middle[i] + last[i]) / h[k] ** 2  # L c2 = -p2
        _apply(inverse, right, c2)
        for i in range(size):
            right[i] = 2 * c2[i] - (4 * middle[i] - 3 * p0[i] - last[i]) / h[k]  # L c1 = 2 c2 - p1
        _apply(inverse, right, c1)
        for i in range(size):
            right[i] = c1[i] - p0[i]  # L c0 = c1 - p0
        _apply(inverse, right, c0)
        for i in range(size):
            right[i] = a[k, i] - c0[i]
        _apply(flow, right, a[k + 1])
        for i in range(size):
            a[k + 1, i] = turned[k] * (a[k + 1, i] + c0[i] + c1[i] * h[k] + c2[i] * h[k] ** 2)
    return a


@njit(cache=True)
def _exponential(L: Complex, h: float, flow: Complex, term: Complex, power: Complex) -> None:
    """Put e^{L h} into `flow`: scaling and squaring of a Taylor series, the trace taken out first."""
    size = len(L)
    mean = np.trace(L) / size
    norm = 0.0
    for i in range(size):
        for j in range(size):
            power[i, j] = (L[i, j] - (mean if i == j else 0.0)) * h
            norm += abs(power[i, j])
            flow[i, j] = 1.0 if i == j else 0.0
    halvings = max(0, math.ceil(math.log2(norm + 1e-300)) + 2)  # norm at most 1/4
    power *= 0.5**halvings
    for order in range(9, 0, -1):  # Horner: 1 + A (1 + A/2 (1 + A/3 (..))); (1/4)^10 / 10! = 3e-13
        _multiply(power, flow, 1 / order, term)
        flow[:] = term
        for i in range(size):
            flow[i, i] += 1
    for _ in range(halvings):
        _multiply(flow, flow, 1.0, term)
        flow[:] = term
    flow *= np.exp(mean * h)


@njit(cache=True)
def _invert(A: Complex, inverse: Complex, work: Complex) -> None:
    """Put A^-1 into `inverse`: Gauss and Jordan with row exchange; for so few rows faster than LAPACK."""
    size = len(A)
    work[:] = A
    inverse[:] = 0
    for i in range(size):
        inverse[i, i] = 1
    for column in range(size):
        best = column
        for row in range(column + 1, size):
            if abs(work[row, column]) > abs(work[best, column]):
                best = row
        for j in range(size):
            work[column, j], work[best, j] = work[best, j], work[column, j]
            inverse[column, j], inverse[best, j] = inverse[best, j], inverse[column, j]
        scale = 1 / work[column, column]
        for j in range(size):
            work[column, j] *= scale
            inverse[column, j] *= scale
        for row in range(size):
            if row != column:
                factor = work[row, column]
                for j in range(size):
                    work[row, j] -= factor * work[column, j]
                    inverse[row, j] -= factor * inverse[column, j]


@njit(cache=True)
def _multiply(A: Complex, B: Complex, factor: float, C: Complex) -> None:
    """Put A B times a factor into C."""
    for i in range(len(A)):
        for j in range(len(A)):
            total = 0j
            for k in range(len(A)):
                total += A[i, k] * B[k, j]
            C[i, j] = total * factor


@njit(cache=True)
def _apply(A: Complex, v: Complex, w: Complex) -> None:
    """Put A v into w."""
    for i in range(len(v)):
        w[i] = 0
        for k in range(len(v)):
            w[i] += A[i, k] * v[k]
