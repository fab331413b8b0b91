"""Steady response to unbalance, bow and harmonic forces (chapter, section 5.5, eq. 9 to 11), as phasors.

q = Re(Q e^{j n theta}); eq. (11) in its real form is the same with Q = q_C - j q_S (as printed there, the signs of
Omega C are swapped: it gives the response of the backward whirl). Order 0 is a load that stands still, -1 one that
turns against the shaft.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig import DataError
from rotorrig.rig.config import RPM
from rotorrig.sims.rotor.model import (
    NO_FORCE,
    NOTHING,
    Amounts,
    Forces,
    Load,
    RotorModel,
    bow_force,
    force_rows,
    hysteretic,
    law_of,
    load,
    matrices,
    patterns,
    speed_stiffness,
    unbalance_force,
)
from rotorrig.sims.rotor.steady.conjugate_solve import solve_with_conjugate

SPEEDS_AT_ONCE = 64  # bounds the memory of a batch: 16 MB at 124 DOF
LOST = 1e-2  # of the load that rounding of Z may come to: beyond, the speed is on a resonance without damping


def steady_response(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Amounts = NOTHING,
    bow: Amounts = NOTHING,
    force: Forces = NO_FORCE,
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return the steady amplitudes Q at the speeds `omega` [rad/s], (speed, dof): m and rad, 0-peak.

    `unbalance` is disk or plane -> U e^{j phi} [kg m], phi from the keyphasor mark in the sense of rotation. `bow` is
    disk or plane -> b e^{j psi} [m], the shaft's residual bow there (loads.bow_force). `force` is disk, plane or
    bearing -> (Fx, Fy) [N], numbers or (speed,) each. `order`: the masses and forces turn that many times per
    revolution. `alpha` [rad/s^2] adds the tangential force of a changing speed, but not the response's lag:
    swept_response.py.

    Raises ValueError on a name the model does not have, DataError on a speed at an undamped resonance.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    loads = load(model, omega, unbalance=unbalance, bow=bow, force=force, order=order, alpha=alpha)
    return _solve(model, omega, loads[..., None], order)[..., 0]


def probe_response(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Amounts = NOTHING,
    bow: Amounts = NOTHING,
    force: Forces = NO_FORCE,
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return what the probes see of `steady_response`, (speed, probe): m, 0-peak, z as in x = Re(z e^{j n theta})."""
    q = steady_response(model, omega, unbalance=unbalance, bow=bow, force=force, order=order, alpha=alpha)
    return q @ model.probes.T


def columns(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Sequence[str] = (),
    bow: Sequence[str] = (),
    force: Sequence[str] = (),
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return d z / d parameter of every linear parameter, (speed, probe, parameter), in one solve.

    One column for each place of `unbalance` [m per kg m] and of `bow` [m per m], then two, Fx and Fy, for each of
    `force` [m per N]. The response is linear in them: `columns @ amounts` is `probe_response` of these amounts.
    Raises as steady_response.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    loads = [
        *(unbalance_force(model, omega, unbalance={name: 1.0}, order=order, alpha=alpha) for name in unbalance),
        *(bow_force(model, name) for name in bow),
        *(row for name in force for row in force_rows(model, name)),
    ]
    if not loads:
        return np.zeros((len(omega), len(model.probes), 0), dtype=complex)
    right = np.stack([np.broadcast_to(column, (len(omega), model.dof)) for column in loads], axis=-1)
    return model.probes @ _solve(model, omega, right, order)


def load_columns(model: RotorModel, omega: ArrayLike, loads: Sequence[Load]) -> NDArray[np.complex128]:
    """Return the steady response to each load, each at its own order, (speed, probe, load) m.

    A stiffness that turns with the shaft is felt at order 1, and the response is then that to a real amount alone.
    Raises as steady_response, ValueError on a pattern of another size too.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    at_probes = np.zeros((len(omega), len(model.probes), len(loads)), dtype=complex)
    pattern = patterns(model, loads)
    for order in {each.order for each in loads}:
        which = [i for i, each in enumerate(loads) if each.order == order]
        law = np.stack([law_of(loads[i], omega, np.zeros(())) for i in which], axis=-1)
        at_probes[..., which] = model.probes @ _solve(model, omega, law[:, None] * pattern[:, which], order)
    return at_probes


def dynamic_stiffness(model: RotorModel, omega: ArrayLike, *, order: float = 1.0) -> NDArray[np.complex128]:
    """Return Z = K - n^2 Omega^2 M + j n Omega (C + Omega G) for order n, (speed, dof, dof) N/m: eq. (11).

    Structural damping D adds j sign(n Omega) D, bearings are as at each speed; what else may stand beside: Added.
    """
    constant = tuple(b for b in model.bearings if b.constant)
    M, C, G, K = matrices(replace(model, bearings=constant))
    O = np.atleast_1d(np.asarray(omega, dtype=float))[:, None, None]  # noqa: E741
    H, S = speed_stiffness(model)
    Z = K + O * H + O**2 * S - (order * O) ** 2 * M + 1j * order * O * (C + O * G)
    D = hysteretic(model)
    if D.any():
        Z = Z + 1j * np.sign(order * O) * D
    for bearing in model.bearings:
        if not bearing.constant:
            k, c = bearing.at(O[:, 0, 0])
            Z = Z + bearing.rows.T @ (k + 1j * order * O * c) @ bearing.rows
    return Z


def _solve(
    model: RotorModel, omega: NDArray[np.float64], loads: NDArray[np.complex128], order: float
) -> NDArray[np.complex128]:
    """Return Z^-1 loads, (speed, dof, load). Raises DataError where rounding decides the answer."""
    if not np.isfinite(omega).all():
        raise ValueError("omega holds NaN or infinity, want speeds in rad/s")
    response = np.empty_like(loads)
    turning = model.added.T if order == 1 else None
    for first in range(0, len(omega), SPEEDS_AT_ONCE):
        some = slice(first, first + SPEEDS_AT_ONCE)
        Z = dynamic_stiffness(model, omega[some], order=order)
        try:
            if turning is None:
                q = response[some] = np.linalg.solve(Z, loads[some])
            else:
                q = response[some] = solve_with_conjugate(Z, turning / 2, loads[some])
        except np.linalg.LinAlgError:
            smallest = np.linalg.svd(Z, compute_uv=False)[:, -1]
            raise _on_resonance(omega[some][np.argmin(smallest)], order) from None
        parts = np.ascontiguousarray(Z).view(float)
        size = np.sqrt(np.einsum("sij,sij->s", parts, parts))  # Frobenius; norm() takes three times as long
        rounding = np.finfo(float).eps * size[:, None] * np.linalg.norm(q, axis=1)
        lost = np.any(rounding > LOST * np.linalg.norm(loads[some], axis=1), axis=-1)
        if lost.any():
            raise _on_resonance(omega[some][np.argmax(lost)], order)
    return response


def _on_resonance(omega: float, order: float) -> DataError:
    """Return what to say of a speed at which Z cannot be inverted."""
    if omega * order == 0:
        return DataError(
            "at rest the bearings' stiffnesses do not hold the rotor, so a load has no response; want more"
        )
    return DataError(
        f"{omega * RPM:.6g} rpm is on a resonance without damping (order {order:g}), so the response has no bound; "
        f"want damping, or another speed"
    )
