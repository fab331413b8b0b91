"""Rotor-fixed stiffness: one that turns with the shaft couples the 1X motion with its own conjugate.

K + Re(T e^{2 j theta}), T symmetric, on a motion Re(A e^{j theta}) exerts -1/2 T conj(A) at 1X. (The other half of it,
-1/2 T A at 3X, meets backward whirl alone and is left out.) So the response is linear in real amounts only: a load
times j has a response of its own. All that is conjugate stands in a second `PassedModes`, beside the one of
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

from rotorrig.sims.rotor.model import Direction, probe_changes
from rotorrig.sims.rotor.steady import solve_with_conjugate
from rotorrig.sims.rotor.swept.envelope import Envelope, Motion, polynomial
from rotorrig.sims.rotor.swept.passed_modes import PassedModes, Spectra
from rotorrig.sims.rotor.swept.passed_modes_derivatives import differentiate_passed_modes
from rotorrig.sims.rotor.swept.time_stepping import SMOOTH, STRAIGHT
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

Complex = NDArray[np.complex128]

CONVERGED = 1e-10  # of the amplitude
MOST_REPEATS = 40  # a step


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledModes:
    """Passed modes coupled with their own conjugate by a rotor-fixed stiffness."""

    conjugate: PassedModes  # of the conjugate motion and the conjugate laws
    direct: PassedModes  # of the motion itself; its L is what the rotor-fixed stiffness adds


def couple_modes(spectra: Spectra, modes: PassedModes, loads: Complex, T: Complex) -> CoupledModes:
    """Couple `modes`, those of `spectra` under loads (dof, load), by the rotor-fixed stiffness T (dof, dof)."""
    G, inputs, outputs = _flexibility(spectra), _inputs(spectra), _outputs(spectra, loads)
    back = T @ G.conj() @ T.conj() / 4
    repeated = inputs @ np.linalg.inv(np.eye(len(T)) - back @ G)
    own = _split(spectra, repeated @ back @ outputs)
    direct = replace(own, g=modes.g + own.g, shape=modes.shape + own.shape, others=modes.others + own.others)
    return CoupledModes(conjugate=_split(spectra, -0.5 * repeated @ T @ outputs.conj()), direct=direct)


def differentiate_coupled_modes(
    spectra: Spectra, change: PassedModes, loads: Complex, T: Complex, directions: Sequence[Direction]
) -> CoupledModes:
    """Differentiate coupled modes along directions, those of T among them; `change` are those of the modes alone.

    An axis of directions comes after that of powers. Of what is of second order, only T is taken to change.
    """
    unit = np.eye(len(T))
    motion_alone = [direction._replace(P=0.0) for direction in directions]
    unit_change = differentiate_passed_modes(replace(spectra, probes=unit), unit.astype(complex), motion_alone)
    at = np.linalg.inv(spectra.fit)  # from coefficients back to values at the speeds
    d_participation, d_shape, d_others = (
        np.moveaxis(np.tensordot(at, part, 1), 1, 0) for part in (unit_change.g, unit_change.shape, unit_change.others)
    )
    inputs, outputs, G = _inputs(spectra), _outputs(spectra, loads), _flexibility(spectra)
    d_probes = probe_changes(directions, len(spectra.probes), len(T))[:, None]
    d_inputs = np.concatenate([d_participation, spectra.probes @ d_others + d_probes @ G], axis=2)
    d_outputs = np.concatenate([d_shape.swapaxes(2, 3), d_others @ loads], axis=3)
    dT = np.array([np.broadcast_to(d.T, T.shape) for d in directions], dtype=complex)[:, None]
    conjugate = -0.5 * ((d_inputs @ T + inputs @ dT) @ outputs.conj() + inputs @ T @ d_outputs.conj())
    d_back = (dT @ G.conj() @ T.conj() + T @ G.conj() @ dT.conj()) / 4
    own = _split(spectra, inputs @ d_back @ outputs)
    direct = PassedModes(
        L=change.L + own.L,
        T=change.T,
        g=change.g + own.g,
        shape=change.shape + own.shape,
        others=change.others + own.others,
    )
    return CoupledModes(conjugate=_split(spectra, conjugate), direct=direct)


def _inputs(spectra: Spectra) -> Complex:
    """Return the participation of a force in the passed modes, then its flexibility at the probes through the others.

    (speed, mode probe, dof)
    """
    m = spectra.passed
    return np.concatenate([spectra.weights @ spectra.by_force[:, :m], spectra.probes @ _flexibility(spectra)], axis=1)


def _outputs(spectra: Spectra, loads: Complex) -> Complex:
    """Return the passed mode shapes, then the others' response to the loads, (speed, dof, mode load)."""
    return np.concatenate([spectra.basis[:, : len(spectra.M)], _flexibility(spectra) @ loads], axis=2)


def _flexibility(spectra: Spectra) -> Complex:
    """Return the others' response to a force, (speed, dof, dof)."""
    m = spectra.passed
    return spectra.vectors[:, : len(spectra.M), m:] @ (spectra.lag[..., None] * spectra.by_force[:, m:])


def _split(spectra: Spectra, product: Complex) -> PassedModes:
    """Split (..., speed, mode probe, mode load) into the parts of PassedModes."""
    m = spectra.passed
    L = spectra.fit_powers(product[..., :m, :m])
    return PassedModes(
        L=L,
        T=np.zeros_like(L),
        g=spectra.fit_powers(product[..., :m, m:]),
        shape=spectra.fit_powers(product[..., m:, :m].swapaxes(-1, -2)),
        others=spectra.fit_powers(product[..., m:, m:]),
    )


def step_coupled_modes(
    envelope: Envelope, modes: CoupledModes, rows: TrackedRows, force: Complex, force_mid: Complex
) -> Motion:
    """Step through a force at the turns and halfway, (turn, mode, column), beginning in the steady state."""
    L, D, C = envelope.operator, polynomial(rows.power, modes.direct.L), polynomial(rows.power, modes.conjugate.L)
    start = solve_with_conjugate(L[0] + D[0], C[0], -force[0])
    a, rate = _step_modes(L, D, C, envelope.steps, envelope.phases, force, force_mid, start)
    return Motion(a=a, rate=rate, average=rows.averages(a, rate, powers=len(modes.conjugate.L)))


@njit(cache=True)
def _step_modes(
    L: Complex,
    D: Complex,
    C: Complex,
    steps: Complex,
    phases: Complex,
    force: Complex,
    force_mid: Complex,
    start: Complex,
) -> tuple[Complex, Complex]:
    """Return a and a' of a' = L a + D a + C conj(a) + force at the turns, (turn, mode, column) each.

    As time_stepping.step_modes, D a + C conj(a) being one more force: over a step a cubic through its values at the
    step's end, its start and the two turns before.
    """
    turns, size, columns = force.shape
    a, rate = np.zeros_like(force), force.copy()
    for c in range(columns):
        pushed, pair, forces = np.zeros((4, size), L.dtype), np.zeros((2, size), L.dtype), np.zeros((3, size), L.dtype)
        a[0, :, c] = start[:, c]
        _put_forces(
            D[0], C[0], start[:, c], pushed[1]
        )  # pushed: at the step's end, at its start, at the two turns before
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
            _step(D[k + 1], C[k + 1], steps[k], phases[k], weights, pushed, forces, pair)
            a[k + 1, :, c] = pair[1]
            for n in range(3, 0, -1):
                pushed[n] = pushed[n - 1]
    return a, rate


@njit(cache=True)
def _step(
    D: Complex,
    C: Complex,
    steps: Complex,
    phases: Complex,
    weights: tuple[float, float, float, float],
    pushed: Complex,
    force: Complex,
    a: Complex,
) -> None:
    """Put the amplitude at the step's end into a[1] from that at its start, a[0], and the push there into pushed[0].

    `force` (3, mode) is that at the start, halfway and at the end. The push at the end depends on the amplitude there:
    solved by fixed-point iteration, which leaves a few per cent each time.
    """
    middle, end = phases
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
        _put_forces(D, C, a[1], pushed[0])
        if change <= CONVERGED * largest:
            break


@njit(cache=True)
def _put_forces(D: Complex, C: Complex, a: Complex, out: Complex) -> None:
    """Put D a + C conj(a) into `out`."""
    for i in range(len(C)):
        out[i] = 0
        for j in range(len(C)):
            out[i] += D[i, j] * a[j] + C[i, j] * a[j].conjugate()
