"""A stiffness that turns with the shaft: at 1X its force goes with the conjugate of the motion.

K + Re(T e^{2 j theta}), T symmetric, on a motion Re(A e^{j theta}) exerts -1/2 T conj(A) at 1X. (The other half of it,
-1/2 T A at 3X, meets backward whirl alone and is left out.) So the response is linear in real amounts only: a load
times j has a response of its own. All that is conjugate stands in a second `Passage`, beside the one of
passed_modes.py: the passed modes follow a' = .. + L conj(a) + g conj(law), the probes see shape conj(a) + others
conj(law) besides.

Through the modes that follow at once, of flexibility G, the force acts on itself: F = -1/2 T conj(w + G F), w the
motion without that, so F = E (-1/2 T conj(w) + 1/4 T G* T* w), E = (1 - 1/4 T G* T* G)^-1. Source: Tondl, Some
Problems of Rotor Dynamics (1965), ch. 2; Genta, Dynamics of Rotating Systems (2005), ch. 6.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Direction
from rotorrig.sims.rotor.steady import solve_with_conjugate
from rotorrig.sims.rotor.swept.envelope import Envelope, Motion, polynomial
from rotorrig.sims.rotor.swept.passed_modes import Passage, Spectra
from rotorrig.sims.rotor.swept.passed_modes_derivatives import passage_derivatives
from rotorrig.sims.rotor.swept.time_stepping import SMOOTH, STRAIGHT
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

SETTLED = 1e-10  # of the amplitude
MOST_REPEATS = 40  # a step


@dataclass(frozen=True, slots=True, kw_only=True)
class Mirror:
    """What a stiffness that turns with the shaft makes of a passage."""

    echo: Passage  # of the conjugate motion and the conjugate laws
    direct: Passage  # of the motion itself; its L is what the turning stiffness adds


def mirror(found: Spectra, modes: Passage, loads: Complex, T: Complex) -> Mirror:
    """Return what T (dof, dof) makes of `modes`, the passage of `found` under loads (dof, load)."""
    G, left, right = _flexibility(found), _left(found), _right(found, loads)
    back = T @ G.conj() @ T.conj() / 4
    repeated = left @ np.linalg.inv(np.eye(len(T)) - back @ G)
    own = _split(found, repeated @ back @ right)
    direct = replace(own, g=modes.g + own.g, shape=modes.shape + own.shape, others=modes.others + own.others)
    return Mirror(echo=_split(found, -0.5 * repeated @ T @ right.conj()), direct=direct)


def mirror_derivatives(
    found: Spectra, change: Passage, loads: Complex, T: Complex, directions: Sequence[Direction]
) -> Mirror:
    """Return the derivatives of a mirror along directions, those of T among them; `change` are those of its modes.

    An axis of directions comes after that of powers. Of what is of second order, only T is taken to change.
    """
    unit = np.eye(len(T))
    moved = passage_derivatives(replace(found, probes=unit), unit.astype(complex), directions)
    at = np.linalg.inv(found.fit)  # from coefficients back to values at the speeds
    d_push, d_shape, d_others = (
        np.moveaxis(np.tensordot(at, part, 1), 1, 0) for part in (moved.g, moved.shape, moved.others)
    )
    left, right, G = _left(found), _right(found, loads), _flexibility(found)
    d_left = np.concatenate([d_push, found.probes @ d_others], axis=2)
    d_right = np.concatenate([d_shape.swapaxes(2, 3), d_others @ loads], axis=3)
    dT = np.array([np.broadcast_to(d.T, T.shape) for d in directions], dtype=complex)[:, None]
    echo = -0.5 * ((d_left @ T + left @ dT) @ right.conj() + left @ T @ d_right.conj())
    d_back = (dT @ G.conj() @ T.conj() + T @ G.conj() @ dT.conj()) / 4
    own = _split(found, left @ d_back @ right)
    direct = Passage(
        L=change.L + own.L,
        T=change.T,
        g=change.g + own.g,
        shape=change.shape + own.shape,
        others=change.others + own.others,
    )
    return Mirror(echo=_split(found, echo), direct=direct)


def _left(found: Spectra) -> Complex:
    """Return what a force does to the passed modes, and through the others to the probes, (speed, mode probe, dof)."""
    m = found.passed
    return np.concatenate([found.weights @ found.by_force[:, :m], found.probes @ _flexibility(found)], axis=1)


def _right(found: Spectra, loads: Complex) -> Complex:
    """Return how the rotor moves with the passed modes, and with the others under loads, (speed, dof, mode load)."""
    return np.concatenate([found.basis[:, : len(found.M)], _flexibility(found) @ loads], axis=2)


def _flexibility(found: Spectra) -> Complex:
    """Return the others' response to a force, (speed, dof, dof)."""
    m = found.passed
    return found.vectors[:, : len(found.M), m:] @ (found.lag[..., None] * found.by_force[:, m:])


def _split(found: Spectra, product: Complex) -> Passage:
    """Return the parts of (..., speed, mode probe, mode load) as a passage."""
    m = found.passed
    L = found.fitted(product[..., :m, :m])
    return Passage(
        L=L,
        T=np.zeros_like(L),
        g=found.fitted(product[..., :m, m:]),
        shape=found.fitted(product[..., m:, :m].swapaxes(-1, -2)),
        others=found.fitted(product[..., m:, m:]),
    )


def driven_with_mirror(
    envelope: Envelope, found: Mirror, rows: TrackedRows, force: Complex, force_mid: Complex
) -> Motion:
    """Return the motion under a force at the turns and halfway, (turn, mode, column), beginning in the steady state."""
    L, D, C = envelope.operator, polynomial(rows.power, found.direct.L), polynomial(rows.power, found.echo.L)
    start = solve_with_conjugate(L[0] + D[0], C[0], -force[0])
    a, rate = _advanced(L, D, C, envelope.steps, envelope.turned, force, force_mid, start)
    return Motion(a=a, rate=rate, average=rows.averages(a, rate, powers=len(found.echo.L)))


@njit(cache=True)
def _advanced(
    L: Complex,
    D: Complex,
    C: Complex,
    steps: Complex,
    turned: Complex,
    force: Complex,
    force_mid: Complex,
    start: Complex,
) -> tuple[Complex, Complex]:
    """Return a and a' of a' = L a + D a + C conj(a) + force at the turns, (turn, mode, column) each.

    As march.advanced, D a + C conj(a) being one more force: over a step a cubic through its values at the step's end,
    its start and the two turns before.
    """
    turns, size, columns = force.shape
    a, rate = np.zeros_like(force), force.copy()
    for c in range(columns):
        pushed, pair, forces = np.zeros((4, size), L.dtype), np.zeros((2, size), L.dtype), np.zeros((3, size), L.dtype)
        a[0, :, c] = start[:, c]
        _push(D[0], C[0], start[:, c], pushed[1])  # pushed: at the step's end, at its start, at the two turns before
        for k in range(turns):
            for i in range(size):
                rate[k, i, c] += pushed[1, i]
                for j in range(size):
                    rate[k, i, c] += L[k, i, j] * a[k, j, c]
            if k + 1 == turns:
                break
            pair[0] = a[k, :, c]
            forces[0], forces[1], forces[2] = force[k, :, c], force_mid[k, :, c], force[k + 1, :, c]
            weights = SMOOTH if k > 1 else STRAIGHT
            _step(D[k + 1], C[k + 1], steps[k], turned[k], weights, pushed, forces, pair)
            a[k + 1, :, c] = pair[1]
            for n in range(3, 0, -1):
                pushed[n] = pushed[n - 1]
    return a, rate


@njit(cache=True)
def _step(
    D: Complex,
    C: Complex,
    steps: Complex,
    turned: Complex,
    weights: tuple[float, float, float, float],
    pushed: Complex,
    force: Complex,
    a: Complex,
) -> None:
    """Put the amplitude at the step's end into a[1] from that at its start, a[0], and the push there into pushed[0].

    `force` (3, mode) is that at the start, halfway and at the end. The push at the end depends on the amplitude there:
    found by repetition, which leaves a few per cent each time.
    """
    middle, end = turned
    size = a.shape[1]
    known, halfway = np.zeros((2, size), dtype=np.complex128)
    for i in range(size):
        halfway[i] = weights[1] * pushed[1, i] + weights[2] * pushed[2, i] + weights[3] * pushed[3, i]
        pushed[0, i] = pushed[1, i]
    for i in range(size):
        for j in range(size):
            past = steps[0, i, j] * a[0, j] + steps[1, i, j] * (force[0, j] + pushed[1, j])
            known[i] += end.conjugate() * (past + middle * steps[2, i, j] * (force[1, j] + halfway[j]))
            known[i] += steps[3, i, j] * force[2, j]
    a[1] = a[0]
    for _ in range(MOST_REPEATS):
        change, largest = 0.0, 0.0
        for i in range(size):
            new = known[i]
            for j in range(size):
                ahead = weights[0] * end.conjugate() * middle * steps[2, i, j] + steps[3, i, j]
                new += ahead * pushed[0, j]
            change, largest = max(change, abs(new - a[1, i])), max(largest, abs(new))
            a[1, i] = new
        _push(D, C, a[1], pushed[0])
        if change <= SETTLED * largest:
            break


@njit(cache=True)
def _push(D: Complex, C: Complex, a: Complex, found: Complex) -> None:
    """Put D a + C conj(a) into `found`."""
    for i in range(len(C)):
        found[i] = 0
        for j in range(len(C)):
            found[i] += D[i, j] * a[j] + C[i, j] * a[j].conjugate()
