"""Loads of a steady response: unbalance, residual bow and given forces, as phasors over speed.

A force is Re(F e^{j n theta}); one that turns with the shaft has (Fx, Fy) proportional to (1, -j) for rotation x to y.
Each is linear in its amount, so the response to a unit of it is also its derivative: harmonic.columns.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg

from rotorrig.rig import DataError
from rotorrig.sims.rotor.model.assembly import RotorModel
from rotorrig.sims.rotor.model.disk import unbalance_direction

Amounts = Mapping[str, complex]  # disk or plane -> amount and phase, in the sense of rotation
Forces = Mapping[str, tuple[ArrayLike, ArrayLike]]  # disk, plane or elastic bearing -> Fx, Fy [N], phasors
NOTHING: Mapping[str, complex] = MappingProxyType({})
NO_FORCE: Forces = MappingProxyType({})

Law = Literal["unbalance", "constant"]

ONE_RECORDING = 1e6  # s on the clock of all recordings from the start of one to that of the next
HELD = 1e-3  # of the least flexibility a free place has: less is rounding, at a place that is pinned


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """A force of fixed pattern, Re(pattern law e^{j order theta}) from the time `since` on.

    The law of an "unbalance" is n^2 Omega^2 - j n alpha at order n, of "constant" 1. One that began before the first
    keyphasor pulse has long been acting; without a timeline there is no time, and every load acts.

    One clock runs through all recordings of a rig, for what stays as it is from one to the next: number k, from 0,
    begins at k `ONE_RECORDING`. Nobody knows how long the rig stood still in between, and nothing depends on it.
    """

    pattern: NDArray[np.complex128]  # (dof,) kg m or N
    law: Law
    order: float = 1
    since: float = -math.inf  # s

    def __post_init__(self) -> None:
        """Raise ValueError on an unknown law."""
        if self.law not in ("unbalance", "constant"):
            raise ValueError(f"law of a load is {self.law!r}, want 'unbalance' or 'constant'")


def recording_at(time: float) -> tuple[int, float]:
    """Return the number of the recording that a moment on the clock of all is in, or next before, and since its start.

    >>> recording_at(1000084.0), recording_at(between_recordings(1))
    ((1, 84.0), (1, -500000.0))
    """
    number = math.floor(time / ONE_RECORDING + 0.5)
    return number, time - number * ONE_RECORDING


def between_recordings(number: int) -> float:
    """Return a moment [s] before recording `number` begins and after the one before has ended."""
    return (number - 0.5) * ONE_RECORDING


def in_recording(load: Load, number: int) -> Load:
    """Return a load on the clock of all recordings as one on that of recording `number`."""
    return load if math.isinf(load.since) else replace(load, since=load.since - number * ONE_RECORDING)


def unbalance_loads(model: RotorModel, places: Sequence[str], *, order: float = 1) -> tuple[Load, ...]:
    """Return the loads of 1 kg m at each of these disks or planes. Raises ValueError on an unknown name."""
    return tuple(Load(unbalance_pattern(model, {place: 1.0}), "unbalance", order) for place in places)


def law_of(load: Load, omega: NDArray[np.float64], alpha: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return a load's law at the shaft's speeds [rad/s] and accelerations [rad/s^2], `since` aside."""
    if load.law == "constant":
        return np.ones(len(omega), dtype=complex)
    return (load.order * omega) ** 2 - 1j * load.order * alpha


def patterns(model: RotorModel, loads: Sequence[Load], *, order: float | None = None) -> NDArray[np.complex128]:
    """Return the patterns side by side, (dof, load). Raises ValueError on another size, or an order unlike `order`."""
    for i, each in enumerate(loads):
        if np.shape(each.pattern) != (model.dof,):
            raise ValueError(f"load {i}: its pattern has shape {np.shape(each.pattern)}, want (dof,) = ({model.dof},)")
        if order is not None and each.order != order:
            raise ValueError(
                f"load {i} is of order {each.order:g}, want {order:g}, as of all loads asked about at once"
            )
    return np.array([each.pattern for each in loads], dtype=complex).reshape(len(loads), model.dof).T


def load(
    model: RotorModel,
    omega: NDArray[np.float64],
    *,
    unbalance: Amounts = NOTHING,
    bow: Amounts = NOTHING,
    force: Forces = NO_FORCE,
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return the sum of all loads at the speeds `omega`, (speed, dof) N; the arguments as in steady_response."""
    total = unbalance_force(model, omega, unbalance=unbalance, order=order, alpha=alpha)
    for place, amount in bow.items():
        total = total + amount * bow_force(model, place)
    for place, (x, y) in force.items():
        rows = force_rows(model, place)
        total = total + np.multiply.outer(x, rows[0]) + np.multiply.outer(y, rows[1])
    return total


def unbalance_force(
    model: RotorModel,
    omega: ArrayLike,
    *,
    unbalance: Amounts,
    order: float = 1.0,
    alpha: ArrayLike = 0.0,
) -> NDArray[np.complex128]:
    """Return the force phasors, (speed, dof) N: (n^2 Omega^2 - j n alpha) U e^{j phi} (1, -j) at the planes.

    F = F_C - j F_S of eq. (9).
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    per_unit = (order * omega) ** 2 - 1j * order * np.asarray(alpha)
    return per_unit[:, None] * unbalance_pattern(model, unbalance)


def unbalance_pattern(model: RotorModel, unbalance: Amounts) -> NDArray[np.complex128]:
    """Return U e^{j phi} (1, -j) summed over the planes, (dof,) kg m: the force phasor per Omega^2."""
    pattern = np.zeros(model.dof, dtype=complex)
    for name, amount in unbalance.items():
        pattern += amount * unbalance_direction(model.plane(name), model.rotation)
    return pattern


def bow_force(model: RotorModel, place: str) -> NDArray[np.complex128]:
    """Return K_s q_b (1, -j), (dof,) N per m, of a shaft bent so that `place` stands off by one metre.

    The shape q_b is that of the shaft pinned at every bearing and pushed at `place`; so at rest, turned by hand, the
    shaft shows it as it is, and no bearing is loaded: K q = K_s q_b has the solution q = q_b. Raises DataError where
    that place cannot stand off: at a bearing.
    """
    shape = bow_shape(model, place)
    return model.shaft.K @ (shape[0] - 1j * model.rotation * shape[1])


def bow_shape(model: RotorModel, place: str) -> NDArray[np.float64]:
    """Return q_b for a bow of one metre at `place` towards x and towards y, (2, dof). Raises as bow_force."""
    push = model.plane(place).rows[:2]
    held = np.vstack([*(b.rows for b in model.bearings), model.appended])
    size = len(held)
    # K_s q + held^T r = push, held q = 0: the pins by Lagrange's multipliers
    scale = np.abs(model.shaft.K).max()
    saddle = np.block([[model.shaft.K, scale * held.T], [scale * held, np.zeros((size, size))]])
    right = np.vstack([push.T, np.zeros((size, 2))])
    q = linalg.lstsq(saddle, right)[0][: model.dof]
    stands_off = push @ q
    # Held nowhere but beside it, the place would still give way by (r.r)^2 / r.K_s.r, by Cauchy and Schwarz.
    least = np.sum(push[0] ** 2) ** 2 / (push[0] @ model.shaft.K @ push[0]) if np.any(push[0]) else np.inf
    if stands_off[0, 0] < HELD * least:
        raise DataError(f"bow at '{place}': a bearing holds the shaft there, want a disk or plane between the bearings")
    return np.linalg.solve(stands_off, q.T)


def force_rows(model: RotorModel, place: str) -> NDArray[np.float64]:
    """Return the rows that read x and y at a disk, plane or elastic bearing, (2, dof). Raises ValueError."""
    places = [(part.name, part.rows) for kind in (model.disks, model.planes, model.bearings) for part in kind]
    named = [rows for name, rows in places if name == place]
    if len(named) != 1:
        raise ValueError(
            f"force: {len(named)} parts are named '{place}', want exactly one of {sorted(name for name, _ in places)}"
        )
    return named[0][:2]
