"""Natural frequencies, critical speeds, mode shapes and sag: what the rotor does by itself.

All take a full or a reduced model; eigenvalues cost dof^3 (about 30 ms at 128 DOF, 0.3 ms at 22), so reduce a model
first where they are asked for often.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize

from rotorrig.sims.rotor.assembly import Matrices, RotorModel, matrices
from rotorrig.sims.rotor.reduction import reduce

LARGE = 60  # coordinates; critical_speeds reduces a larger model first, to half as many modes
SCAN = 24  # speeds at which critical_speeds looks for crossings
GRAVITY = 9.80665  # m/s^2
_DOWN = {"-x": (-GRAVITY, 0.0), "-y": (0.0, -GRAVITY), "none": (0.0, 0.0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One damped mode: the motion is Re(shape e^{eigenvalue t})."""

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
    values, vectors = linalg.eig(state_matrix(matrices(model), omega))
    lowest = sorted(np.flatnonzero(values.imag > 0), key=lambda i: values[i].imag)[:count]
    modes = []
    for i in lowest:
        shape = model.centreline @ vectors[: model.dof, i]
        modes.append(Mode(eigenvalue=complex(values[i]), shape=shape / shape.flat[np.argmax(abs(shape))]))
    return tuple(modes)


def natural_frequencies(model: RotorModel, omega: float) -> NDArray[np.float64]:
    """Return every damped natural frequency at shaft speed `omega`, (dof,) rad/s, rising; 0 for an overdamped mode."""
    values = linalg.eigvals(state_matrix(matrices(model), omega))
    return np.sort(np.abs(values.imag))[::2]  # they come in pairs: conjugate, or both real


def critical_speeds(model: RotorModel, *, up_to: float) -> NDArray[np.float64]:
    """Return the shaft speeds at which a damped natural frequency equals the speed (1X), rad/s, rising.

    Every crossing of the Campbell diagram counts, backward whirls too. Two crossings of one branch within
    `up_to` / SCAN are missed. Raises ValueError unless `up_to` [rad/s] is positive.
    """
    if not up_to > 0:
        raise ValueError(f"up_to is {up_to:g} rad/s, want a speed above zero")
    small = model if model.dof <= LARGE else reduce(model, modes=LARGE // 2)
    speeds = np.linspace(up_to / SCAN, up_to, SCAN)
    above = np.array([natural_frequencies(small, omega) - omega for omega in speeds])
    steps, branches = np.nonzero((above[:-1] > 0) != (above[1:] > 0))
    crossings = [_crossing(small, int(branch), *speeds[i : i + 2]) for i, branch in zip(steps, branches, strict=True)]
    return np.sort(np.array(crossings, dtype=float))


def static_sag(model: RotorModel, gravity: str) -> NDArray[np.float64]:
    """Return the centreline under its own weight at rest, (2, node) m; `gravity` as in RigConfig: "-x", "-y", "none".

    Raises ValueError on another direction, or if the bearings do not hold the shaft.
    """
    if gravity not in _DOWN:
        raise ValueError(f"gravity is {gravity!r}, want one of {list(_DOWN)}")
    down = np.array(_DOWN[gravity])
    load = down @ model.weight
    for disk in model.disks:
        load = load + disk.mass * down @ disk.rows[:2]
    try:
        return model.centreline @ np.linalg.solve(matrices(model).K, load)
    except np.linalg.LinAlgError as error:
        raise ValueError("the bearings' stiffnesses do not hold the shaft, so it has no sag") from error


def _crossing(model: RotorModel, branch: int, low: float, high: float) -> float:
    """Return the speed in [low, high] at which the natural frequency number `branch` equals it."""

    def above(omega: float) -> float:
        return float(natural_frequencies(model, omega)[branch]) - omega

    return float(optimize.brentq(above, low, high, rtol=1e-10))


def state_matrix(system: Matrices, omega: float) -> NDArray[np.float64]:
    """Return A(Omega) of (q, q')' = A (q, q') without force, (2 dof, 2 dof)."""
    M, C, G, K = system
    lower = linalg.solve(M, -np.hstack([K, C + omega * G]), assume_a="pos")
    return np.vstack([np.hstack([np.zeros_like(M), np.eye(len(M))]), lower])
