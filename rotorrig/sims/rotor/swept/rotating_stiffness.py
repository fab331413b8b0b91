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
from rotorrig.sims.rotor.swept.time_stepping import SMOOTH, STRAIGHT, add_matrix
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

Complex = NDArray[np.complex128]


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
    ahead = _push_ahead(envelope.steps, envelope.phases)
    own, mirrored = _inverse_with_conjugate(np.eye(L.shape[-1]) - ahead @ D[1:], -ahead @ C[1:])
    a, rate = _step_modes(L, D, C, envelope.steps, envelope.phases, own, mirrored, force, force_mid, start)
    return Motion(a=a, rate=rate, average=rows.averages(a, rate, powers=len(modes.conjugate.L)))


def _push_ahead(steps: Complex, phases: Complex) -> Complex:
    """Return what a push at a step's end does to the amplitude there, (step, mode, mode)."""
    weight = np.where(np.arange(len(steps)) > 1, SMOOTH[0], STRAIGHT[0])
    halfway = weight * phases[:, 1].conj() * phases[:, 0]
    return halfway[:, None, None] * steps[:, 2] + steps[:, 3]


def _inverse_with_conjugate(Z: Complex, C: Complex) -> tuple[Complex, Complex]:
    """Return P, Q of q = P right + Q conj(right) where Z q + C conj(q) = right, all (..., n, n)."""
    unit = np.broadcast_to(np.eye(Z.shape[-1], dtype=complex), Z.shape)
    real, imaginary = solve_with_conjugate(Z, C, unit), -1j * solve_with_conjugate(Z, C, 1j * unit)
    return (real + imaginary) / 2, (real - imaginary) / 2


@njit(cache=True)
def _step_modes(
    L: Complex,
    D: Complex,
    C: Complex,
    steps: Complex,
    phases: Complex,
    own: Complex,
    mirrored: Complex,
    force: Complex,
    force_mid: Complex,
    start: Complex,
) -> tuple[Complex, Complex]:
    """Return a and a' of a' = L a + D a + C conj(a) + force at the turns, (turn, mode, column) each.

    As time_stepping.step_modes, D a + C conj(a) being one more force, a push: over a step a cubic through its values at
    the step's end, its start and the two turns before. `own` and `mirrored` (step, mode, mode) solve for the amplitude
    at the end, on which the push there depends.
    """
    turns, size, columns = force.shape
    a, rate = np.zeros_like(force), force.copy()
    pushed = np.zeros((3, size, columns), L.dtype)  # at the step's start, at the two turns before
    a[0] = start
    for k in range(turns):
        pushed[2], pushed[1], pushed[0] = pushed[1], pushed[0], 0
        add_matrix(D[k], a[k], 1.0, pushed[0])
        _add_times_conjugate(C[k], a[k], pushed[0])
        rate[k] += pushed[0]
        add_matrix(L[k], a[k], 1.0, rate[k])
        if k + 1 < turns:
            _, now, last, before = SMOOTH if k > 1 else STRAIGHT
            middle, end = phases[k]
            known, halfway = (
                np.zeros_like(start),
                force_mid[k] + now * pushed[0] + last * pushed[1] + before * pushed[2],
            )
            add_matrix(steps[k, 0], a[k], end.conjugate(), known)
            add_matrix(steps[k, 1], force[k] + pushed[0], end.conjugate(), known)
            add_matrix(steps[k, 2], halfway, end.conjugate() * middle, known)
            add_matrix(steps[k, 3], force[k + 1], 1.0, known)
            add_matrix(own[k], known, 1.0, a[k + 1])
            _add_times_conjugate(mirrored[k], known, a[k + 1])
    return a, rate


@njit(cache=True)
def _add_times_conjugate(A: Complex, x: Complex, y: Complex) -> None:
    """Add A conj(x) to y, x and y (row, column)."""
    for i in range(len(A)):
        for j in range(len(x)):
            for c in range(x.shape[1]):
                y[i, c] += A[i, j] * x[j, c].conjugate()
