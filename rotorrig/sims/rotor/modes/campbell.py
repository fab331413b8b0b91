"""The Campbell diagram and stability: how frequencies, damping and whirl move with the shaft speed.

Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), ch. 5 (natural frequency maps) and ch. 7
(cross-coupling, rotating damping, stability).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import optimize

from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.modes.modes import (
    Mode,
    eigenpairs,
    eigenvalues,
    mode_of,
    reduce_if_large,
    rounding_limit,
    whirl_modes,
)

SPARE = 6  # modes beyond those asked for, among which a branch may find its continuation
ANOTHER = 1.0  # a step of a branch with a larger change of eigenvalue and shape is one to another mode
SCAN = 48  # speeds at which stability_onset looks
ENDED = complex(np.nan, np.nan)
DRIFT = 0.1  # rad/s: slower is a shaft that no bearing holds, moving as one piece
MARGINAL = 1e-7  # of |eigenvalue|: growth not told from rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Campbell:
    """Branches of modes followed over the speed; NaN where a branch has ended (its mode no longer oscillates)."""

    omega: NDArray[np.float64]  # (speed,) rad/s
    eigenvalues: NDArray[np.complex128]  # (speed, branch) rad/s
    whirl: NDArray[np.float64]  # (speed, branch), +1 circular from x towards y, -1 from y towards x

    @property
    def frequency(self) -> NDArray[np.float64]:
        """Damped natural frequencies, (speed, branch) rad/s."""
        return self.eigenvalues.imag

    @property
    def damping_ratio(self) -> NDArray[np.float64]:
        """Damping as a fraction of critical, (speed, branch); negative: unstable."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)


def campbell(model: RotorModel, omega: ArrayLike, *, count: int = 8) -> Campbell:
    """Return the `count` modes lowest at the first of the speeds `omega` [rad/s], each followed over the others.

    A branch goes on where eigenvalue and shape change least from what its last two speeds foretell; so give the speeds
    in order and close enough (a few dozen). In an isotropic rotor at rest the whirl of a pair is arbitrary.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    small = reduce_if_large(model)
    branches: list[list[Mode | None]] = [[mode] for mode in whirl_modes(small, omega[0], count=count)]
    for speed in omega[1:]:
        candidates = whirl_modes(small, speed, count=count + SPARE)
        for branch, mode in zip(branches, _match_branches(branches, candidates), strict=True):
            branch.append(mode)
    return Campbell(
        omega=omega,
        eigenvalues=np.array([[mode.eigenvalue if mode else ENDED for mode in row] for row in branches]).T,
        whirl=np.array([[mode.whirl if mode else np.nan for mode in row] for row in branches]).T,
    )


def stability_onset(model: RotorModel, *, up_to: float) -> Mode | None:
    """Return the mode that is the first to grow as the speed rises from rest to `up_to` [rad/s], at that speed.

    None if there is none; at omega = 0 the rotor is unstable at rest. A window of instability narrower than
    `up_to` / SCAN is missed. Raises ValueError unless `up_to` is positive.
    """
    if not up_to > 0:
        raise ValueError(f"up_to is {up_to:g} rad/s, want a speed above zero")
    small = reduce_if_large(model)
    speeds = np.linspace(0.0, up_to, SCAN + 1)
    growth = np.array([_growth(small, speed) for speed in speeds])
    if not np.any(growth > 0):
        return None
    first = int(np.argmax(growth > 0))
    if first == 0:
        return _fastest_growing(small, 0.0)
    low, high = float(speeds[first - 1]), float(speeds[first])
    return _fastest_growing(small, float(optimize.brentq(lambda speed: _growth(small, speed), low, high, rtol=1e-10)))


def _match_branches(branches: list[list[Mode | None]], candidates: tuple[Mode, ...]) -> list[Mode | None]:
    """Return the continuation of every branch among the candidates, the sum of all changes being least."""
    change = np.array([[_change(branch, mode) for mode in candidates] for branch in branches])
    change = np.minimum(change, ANOTHER)  # a branch that has ended takes no other's continuation
    taken: list[Mode | None] = [None] * len(branches)
    for branch, mode in zip(*optimize.linear_sum_assignment(change), strict=True):
        if change[branch, mode] < ANOTHER:
            taken[branch] = candidates[mode]
    return taken


def _change(branch: list[Mode | None], mode: Mode) -> float:
    """Return how far a mode is from where its branch leads: relative in eigenvalue, plus 1 - MAC in shape."""
    last, before = branch[-1], branch[-2] if len(branch) > 1 else None
    if last is None:
        return ANOTHER
    foretold = last.eigenvalue
    if before is not None and last.omega != before.omega:
        step = (mode.omega - last.omega) / (last.omega - before.omega)
        foretold = foretold + step * (last.eigenvalue - before.eigenvalue)
    a, b = last.shape.ravel(), mode.shape.ravel()
    alike = abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a) * np.vdot(b, b)).real  # modal assurance criterion
    return float(abs(mode.eigenvalue - foretold) / abs(last.eigenvalue) + 1 - alike)


def _growth(model: RotorModel, omega: float) -> float:
    """Return the largest growth rate, as a part of |eigenvalue|, less what rounding can feign."""
    return float(np.max(_rates(model, eigenvalues(model, omega)))) - MARGINAL


def _fastest_growing(model: RotorModel, omega: float) -> Mode:
    values, vectors = eigenpairs(model, omega)
    i = np.argmax(_rates(model, values))
    return mode_of(model, omega, values[i], vectors[:, i])


def _rates(model: RotorModel, values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return Re / |eigenvalue|; -1 where that is no growth: for a drift, and for the other half of each pair."""
    size = np.abs(values)
    meant = (values.imag >= -rounding_limit(model) * size) & (size > DRIFT)
    return np.where(meant, values.real / np.maximum(size, DRIFT), -1.0)
