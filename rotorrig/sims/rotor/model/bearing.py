"""The linear bearing (chapter, section 5.3, eq. 7), attached to the shaft by the rows that read its motion."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.rig import ConfigError
from rotorrig.rig.config import Bearing, OverSpeed

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingAttachment:
    """Eight coefficients between ground and the journal, whose x and y are `rows @ q`.

    They are given at one or more shaft speeds: straight lines between these, held at the ends' values beyond them.
    """

    name: str
    rows: Matrix  # (2, dof)
    omega: Matrix  # (knot,) rad/s, rising
    stiffness: Matrix  # (knot, 2, 2) N/m
    damping: Matrix  # (knot, 2, 2) N s/m

    @property
    def constant(self) -> bool:
        """True if the coefficients are the same at every speed."""
        return len(self.omega) == 1

    @property
    def K(self) -> Matrix:  # noqa: N802
        """The constant stiffness, (2, 2) N/m. Raises ConfigError if it depends on speed."""
        self._check_constant()
        return self.stiffness[0]

    @property
    def C(self) -> Matrix:  # noqa: N802
        """The constant damping, (2, 2) N s/m. Raises ConfigError if it depends on speed."""
        self._check_constant()
        return self.damping[0]

    def at(self, omega: ArrayLike) -> tuple[Matrix, Matrix]:
        """Return K and C at the shaft speeds `omega` [rad/s], (..., 2, 2) each; of a negative speed, its magnitude."""
        speed = np.abs(np.asarray(omega, dtype=float))

        def between(table: Matrix) -> Matrix:
            entries = [np.interp(speed, self.omega, table[:, i, j]) for i in (0, 1) for j in (0, 1)]
            return np.stack(entries, axis=-1).reshape(*speed.shape, 2, 2)

        return between(self.stiffness), between(self.damping)

    def _check_constant(self) -> None:
        if not self.constant:
            raise ConfigError(f"bearing '{self.name}': its coefficients depend on speed, want constants for this")


@dataclass(frozen=True, slots=True, kw_only=True)
class TiltAttachment:
    """What a bearing, a rigid one too, does against the tilt a, b of the shaft in it, `rows @ q`: alike in both."""

    name: str
    rows: Matrix  # (2, dof)
    stiffness: float  # N m/rad


def attach_bearing(bearing: Bearing, rows: Matrix) -> BearingAttachment:
    """Attach a nameplate bearing, not a rigid one, to the journal that `rows` (2, dof) read."""
    tables = [value for name in bearing.model_fields_set if isinstance(value := getattr(bearing, name), OverSpeed)]
    omega = np.unique([speed for table in tables for speed in table.speed] or [0.0])

    def matrix(kind: str) -> Matrix:
        entries = [[_values(getattr(bearing, f"{kind}{i}{j}"), omega) for j in "xy"] for i in "xy"]
        return np.moveaxis(np.array(entries), -1, 0)

    return BearingAttachment(name=bearing.name, rows=rows, omega=omega, stiffness=matrix("k"), damping=matrix("c"))


def with_coefficients(bearing: BearingAttachment, K: ArrayLike, C: ArrayLike) -> BearingAttachment:
    """Return the bearing with constant K [N/m] and C [N s/m], (2, 2) each.

    Raises ValueError on another shape, on NaN or infinity and on a negative direct stiffness or damping.
    """
    checked = [_check_coefficients(label, matrix, bearing.name)[None] for label, matrix in (("K", K), ("C", C))]
    return replace(bearing, omega=np.zeros(1), stiffness=checked[0], damping=checked[1])


def bearing_stiffness(bearing: BearingAttachment, omega: float | None = None) -> Matrix:
    """Return K^b of eq. (7), (dof, dof). Raises ConfigError without a speed if it depends on that."""
    K = bearing.K if omega is None else bearing.at(omega)[0]
    return bearing.rows.T @ K @ bearing.rows


def bearing_damping(bearing: BearingAttachment, omega: float | None = None) -> Matrix:
    """Return C^b of eq. (7), (dof, dof). Raises ConfigError without a speed if it depends on that."""
    C = bearing.C if omega is None else bearing.at(omega)[1]
    return bearing.rows.T @ C @ bearing.rows


def tilt_stiffness(tilt: TiltAttachment) -> Matrix:
    """Return what a bearing's resistance to tilt adds to the stiffness, (dof, dof)."""
    return tilt.stiffness * (tilt.rows.T @ tilt.rows)


def _values(coefficient: float | OverSpeed, omega: Matrix) -> Matrix:
    """Return a coefficient at the speeds of all tables of its bearing; between them it is straight."""
    if isinstance(coefficient, OverSpeed):
        return np.interp(omega, coefficient.speed, coefficient.value)
    return np.full(len(omega), coefficient)


def _check_coefficients(label: str, matrix: ArrayLike, name: str) -> Matrix:
    matrix = np.asarray(matrix, dtype=float)
    if matrix.shape != (2, 2):
        raise ValueError(f"{label} has shape {matrix.shape}, want (2, 2)")
    if not np.isfinite(matrix).all() or matrix.diagonal().min() < 0:
        raise ValueError(
            f"{label} of bearing '{name}' is {matrix.tolist()}, want numbers, none negative on the diagonal"
        )
    return matrix
