"""Natural frequencies, critical speeds, mode shapes and sag of the free rotor.

All take a full or a reduced model; eigenvalues cost dof^3 (about 30 ms at 128 DOF, 0.3 ms at 22), so reduce a model
first where they are asked for often. The Campbell diagram and stability are in campbell.py.

Structural damping is K + j H for a motion e^{lambda t} with Im lambda > 0, so only such eigenvalues are kept: exact
for a steady vibration, and the usual approximation for a decaying one (H small against K).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

from rotorrig.sims.rotor.model import Matrices, RotorModel, hysteretic, matrices, reduce, speed_stiffness

LARGE = 60  # coordinates; what scans over speeds reduces a larger model first, to half as many modes
SCAN = 24  # speeds at which critical_modes looks for crossings
ROUNDING = 1e-7  # of |lambda|; the two eigenvalues of a double root part by the square root of a double's precision
HELD = 1e12  # condition of the stiffness, its diagonal scaled to one: beyond, the rotor is free but for rounding
GRAVITY = 9.80665  # m/s^2
DOWN = {"-x": (-GRAVITY, 0.0), "-y": (0.0, -GRAVITY), "none": (0.0, 0.0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One damped mode at one shaft speed: the motion is Re(shape e^{eigenvalue t})."""

    omega: float  # rad/s, the shaft speed
    eigenvalue: complex  # rad/s
    shape: NDArray[np.complex128]  # (2, node): x and y of the centreline, largest component 1

    @property
    def frequency(self) -> float:
        """Damped natural frequency [rad/s]."""
        return self.eigenvalue.imag

    @property
    def damping_ratio(self) -> float:
        """Damping as a fraction of critical; negative: unstable."""
        return -self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def whirl(self) -> float:
        """Sense of the whirl, from +1 (circular, x towards y) over 0 (along a line) to -1."""
        x, y = self.shape
        return float(-2 * np.sum((x.conj() * y).imag) / np.sum(abs(self.shape) ** 2))


def whirl_modes(model: RotorModel, omega: float, *, count: int = 8) -> tuple[Mode, ...]:
    """Return the lowest oscillating modes at shaft speed `omega` [rad/s], by damped natural frequency."""
    values, vectors = eigenpairs(model, omega)
    lowest = sorted(np.flatnonzero(oscillating(model, values)), key=lambda i: values[i].imag)[:count]
    return tuple(mode_of(model, omega, values[i], vectors[:, i]) for i in lowest)


def natural_frequencies(model: RotorModel, omega: float) -> NDArray[np.float64]:
    """Return every damped natural frequency at shaft speed `omega`, (dof,) rad/s, rising; 0 for an overdamped mode."""
    values = eigenvalues(model, omega)
    rising = np.sort(values.imag[oscillating(model, values)])
    return np.concatenate([np.zeros(model.dof - len(rising)), rising])


def critical_speeds(model: RotorModel, *, up_to: float, order: float = 1.0) -> NDArray[np.float64]:
    """Return the shaft speeds at which a damped natural frequency equals `order` times the speed, rad/s, rising.

    As `critical_modes`, which also tells damping and whirl.
    """
    return np.array([mode.omega for mode in critical_modes(model, up_to=up_to, order=order)])


def critical_modes(model: RotorModel, *, up_to: float, order: float = 1.0) -> tuple[Mode, ...]:
    """Return the modes met where the Campbell diagram crosses the line of `order` per turn, by shaft speed.

    Every crossing counts, backward whirls too. Two crossings of one branch within `up_to` / SCAN are missed.
    Raises ValueError unless `up_to` [rad/s] and `order` are positive.
    """
    if not up_to > 0:
        raise ValueError(f"up_to is {up_to:g} rad/s, want a speed above zero")
    if not order > 0:
        raise ValueError(f"order is {order:g}, want one above zero")
    small = reduce_if_large(model)
    speeds = np.linspace(up_to / SCAN, up_to, SCAN)
    # The k-th frequency of the sorted list is continuous in speed, whatever branches cross in it.
    above = np.array([natural_frequencies(small, omega) - order * omega for omega in speeds])
    steps, branches = np.nonzero((above[:-1] > 0) != (above[1:] > 0))
    crossings = [
        _crossing(small, int(branch), order, *speeds[i : i + 2]) for i, branch in zip(steps, branches, strict=True)
    ]
    return tuple(sorted(crossings, key=lambda mode: mode.omega))


def reduce_if_large(model: RotorModel) -> RotorModel:
    """Return the model, reduced if it is too large for eigenvalues at many speeds."""
    return model if model.dof <= LARGE else reduce(model, modes=LARGE // 2)


def static_sag(model: RotorModel, gravity: str) -> NDArray[np.float64]:
    """Return the centreline under its own weight at rest, (2, node) m; `gravity` as in RigConfig: "-x", "-y", "none".

    Raises ValueError on another direction, or if the bearings do not hold the shaft.
    """
    if gravity not in DOWN:
        raise ValueError(f"gravity is {gravity!r}, want one of {list(DOWN)}")
    q = static_solution(model, matrices(model, 0.0).K, weight(model, gravity))
    return model.centreline @ q


def static_solution(model: RotorModel, K: NDArray[np.float64], load: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the solution of K q = load, whose first coordinates are the model's.

    Raises LinAlgError, a ValueError, if K holds nothing.
    Rounding can make a singular K solvable: a sag as long as the rotor is no answer of a small-deflection theory.
    """
    try:
        q = np.linalg.solve(K, load).astype(float)
    except np.linalg.LinAlgError:
        q = np.full_like(load, np.inf)
    if not np.all(np.abs(model.centreline @ q[: model.dof]) < np.ptp(model.z)):
        raise np.linalg.LinAlgError("the bearings' stiffnesses do not hold the shaft, so it has no place of rest")
    return q


def weight(model: RotorModel, gravity: str) -> NDArray[np.float64]:
    """Return the load of shaft and disks, (dof,) N; `gravity` as in static_sag."""
    down = np.array(DOWN[gravity])
    return down @ model.weight + sum(disk.mass * down @ disk.rows[:2] for disk in model.disks)


def state_matrix(system: Matrices, omega: float) -> NDArray:
    """Return A(Omega) of (q, q')' = A (q, q') without force, (2 dof, 2 dof); complex where K is."""
    M, C, G, K = system
    lower = linalg.solve(M, -np.hstack([K, C + omega * G]), assume_a="pos")
    return np.vstack([np.hstack([np.zeros_like(M), np.eye(len(M))]), lower])


def eigenvalues(model: RotorModel, omega: float) -> NDArray[np.complex128]:
    """Return every eigenvalue at shaft speed `omega`, (2 dof,) rad/s."""
    matrix, inverse = _eigenproblem(model, omega)
    values = np.linalg.eigvals(matrix).astype(np.complex128)
    return np.reciprocal(values) if inverse else values


def eigenpairs(model: RotorModel, omega: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return every eigenvalue at shaft speed `omega`, (2 dof,) rad/s, and its (q, q'), (2 dof, 2 dof), by columns."""
    matrix, inverse = _eigenproblem(model, omega)
    values, vectors = (part.astype(np.complex128) for part in np.linalg.eig(matrix))
    return (np.reciprocal(values) if inverse else values), vectors


def _eigenproblem(model: RotorModel, omega: float) -> tuple[NDArray, bool]:
    """Return the state matrix or, where the bearings hold the rotor, its inverse, and whether it is that.

    Rounding spoils all eigenvalues by a part of the largest. Of the state matrix that is the shaft's stiffest motion,
    of its inverse the lowest mode, the one that is asked for (Golub and Van Loan, Matrix Computations, 7.2).
    """
    M, C, G, K = _system(model, omega)
    size = np.sqrt(np.abs(K.diagonal()))
    if not size.all() or np.linalg.cond(K / np.outer(size, size)) > HELD:
        return state_matrix(Matrices(M, C, G, K), omega), False
    upper = -np.linalg.solve(K, np.hstack([C + omega * G, M]))
    return np.vstack([upper, np.hstack([np.eye(len(M)), np.zeros_like(M)])]), True


def oscillating(model: RotorModel, values: NDArray[np.complex128]) -> NDArray[np.bool_]:
    """Return which eigenvalues are of modes that vibrate, one of each pair."""
    return values.imag > rounding_limit(model) * np.abs(values)


def rounding_limit(model: RotorModel) -> float:
    """Return the part of |lambda| that Im lambda may be of a mode that does not vibrate.

    It is rounding, or what structural damping makes of an overdamped mode: the loss factor at the most.
    """
    return ROUNDING + 2 * (model.structural_damping + _loss(model))


def mode_of(model: RotorModel, omega: float, value: complex, vector: NDArray[np.complex128]) -> Mode:
    """Return an eigenvalue and its (q, q') as a mode."""
    shape = model.centreline @ vector[: model.dof]
    return Mode(omega=omega, eigenvalue=complex(value), shape=shape / shape.flat[np.argmax(abs(shape))])


def _system(model: RotorModel, omega: float) -> Matrices:
    """Return the matrices at that speed, stiffness by speed and structural damping in K."""
    system = matrices(model, omega)
    H, S = speed_stiffness(model)
    K, D = system.K + omega * H + omega**2 * S, hysteretic(model)
    return system._replace(K=K + 1j * D if D.any() else K)


def _loss(model: RotorModel) -> float:
    """Return the largest part of a coordinate's stiffness that an added loss comes to."""
    if model.added.K is None or not np.iscomplexobj(model.added.K):
        return 0.0
    loss, K = np.abs(model.added.K.imag.diagonal()), matrices(model, 0.0).K.diagonal()
    return float(np.max(loss[loss > 0] / K[loss > 0], initial=0.0))


def _crossing(model: RotorModel, branch: int, order: float, low: float, high: float) -> Mode:
    """Return the mode of natural frequency number `branch` at the speed in [low, high] where it meets the order."""

    def above(omega: float) -> float:
        return float(natural_frequencies(model, omega)[branch]) - order * omega

    omega = float(optimize.brentq(above, low, high, rtol=1e-10))
    modes = whirl_modes(model, omega, count=model.dof)
    return modes[branch - (model.dof - len(modes))]  # the overdamped ones come first, as zeros
