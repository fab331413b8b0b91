"""The fast path of a search: everything but a few bearings is condensed once per speed grid; a candidate is then cheap.

With the bearings that change at a reference d0, the receptances H between bearings (b), loads (f) and probes (p) give,
for any other K + j Omega C, exactly (receptance_kernels.py):

    (I + D H_bb) r = D H_bf u,    z_p = H_pf u - H_pb r,    D = K - d0 + j Omega C

a solve of twice the number of those bearings per speed, whatever the size of the model. The reference is damped: an
undamped rest of the rotor has resonances of its own inside the grid, where H would be useless. Measured costs and
errors: docs/forward-speed.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import lapack

from rotorrig.rig import DataError
from rotorrig.rig.config import RPM
from rotorrig.sims.rotor.model import (
    RotorModel,
    hysteretic,
    matrices,
    speed_stiffness,
    unbalance_direction,
    with_bearing,
)
from rotorrig.sims.rotor.steady import receptance_kernels as kernels

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
Powers = tuple[NDArray[np.complexfloating], ...]

SOFTEST_REFERENCE = 1e4  # N/m
_NARROW = 2  # a matrix this many times as wide as its band is solved as a banded one, in two thirds of the time
_OBJECTIVES = {"f1": kernels.F1, "f2": kernels.F2, "f3": kernels.F3}
_DIRECT = [0, 3, 4, 7]  # kxx, kyy, cxx, cyy among the coefficients


class ReceptanceDerivatives(NamedTuple):
    """The response of one candidate and its derivatives, all analytic."""

    z: Complex  # (speed, probe) m
    by_stiffness: Complex  # (group, 2, 2, speed, probe) m per N/m, rows and columns as in K
    by_damping: Complex  # (group, 2, 2, speed, probe) m per N s/m
    by_amount: Complex  # (load, speed, probe) m per unit of Re u; by Im u it is j times this


@dataclass(frozen=True, slots=True, kw_only=True)
class Receptance:
    """Receptances over a speed grid for groups of bearings, alike within a group, and loads of changing amount."""

    omega: Real  # (speed,) rad/s
    groups: tuple[tuple[str, ...], ...]  # names of the bearings that change
    loads: int
    probes: int
    H: Real  # (2, row, column, speed), see receptance_kernels.py
    group: NDArray[np.int64]  # (bearing,) the number of its group
    reference: complex  # N/m, d0

    def response(self, kxx: ArrayLike, kyy: ArrayLike, cxx: ArrayLike, cyy: ArrayLike, u: ArrayLike) -> Complex:
        """Return the 1X amplitudes at the probes, (..., speed, probe) m, 0-peak.

        The arguments [N/m, N s/m, kg m] broadcast: numbers for one candidate, (n,) for a population. Every group has
        these coefficients, every load the amount `u`, which may be complex: U e^{j phi}. Raises ValueError on NaN or
        infinity and on a negative coefficient, DataError on a speed at an undamped resonance.
        """
        return self._answer(*self._diagonal(kxx, kyy, cxx, cyy, u))

    def misfit(
        self,
        measured: Real,
        kxx: ArrayLike,
        kyy: ArrayLike,
        cxx: ArrayLike,
        cyy: ArrayLike,
        u: ArrayLike,
        *,
        objective: str,
        slow_roll: bool = False,
    ) -> Real:
        """Return an objective of the chapter on amplitudes, (...); arguments as in `response`.

        "f1" sums squared differences [um^2], eq. (14); "f2" absolute differences of the logarithms to base 10, eq.
        (15); "f3" absolute differences [um], eq. (16).

        `measured` (speed, probe) m, 0-peak, NaN where left out. With `slow_roll` the last speed is the slow roll: its
        vector is subtracted from the others, and `measured` has no row for it.
        """
        if objective not in _OBJECTIVES:
            raise ValueError(f"objective is {objective!r}, want one of {list(_OBJECTIVES)}")
        want = (len(self.omega) - slow_roll, self.probes)
        if measured.shape != want:
            raise ValueError(f"measured has shape {measured.shape}, want (speed, probe) = {want}")
        coefficients, amounts, shape = self._diagonal(kxx, kyy, cxx, cyy, u)
        out = np.empty(len(coefficients))
        columns = np.ascontiguousarray(measured.T)
        bad = kernels.misfit(*self._condensed, coefficients, amounts, columns, slow_roll, _OBJECTIVES[objective], out)
        if bad >= 0:
            self._refuse(coefficients[bad], amounts[bad], bad)
        return out.reshape(shape)

    def general_response(self, K: ArrayLike, C: ArrayLike, u: ArrayLike) -> Complex:
        """Return the response for all eight coefficients of every group, (..., speed, probe) m.

        `K` and `C` are (..., group, 2, 2), `u` (..., load); what stands before broadcasts. Raises as `response`.
        """
        return self._answer(*self._general(K, C, u))

    def response_and_derivatives(self, K: ArrayLike, C: ArrayLike, u: ArrayLike) -> ReceptanceDerivatives:
        """Return the response of one candidate and its derivatives; K, C (group, 2, 2), u (load,). Raises likewise."""
        coefficients, amounts, shape = self._general(K, C, u)
        if shape:
            raise ValueError(f"got candidates of shape {shape}, want one: K and C (group, 2, 2), u (load,)")
        speeds, groups = len(self.omega), len(self.groups)
        z = np.empty((self.probes, speeds), dtype=complex)
        by_coefficient = np.empty((groups, kernels.COEFFICIENTS, self.probes, speeds), dtype=complex)
        by_amount = np.empty((self.loads, self.probes, speeds), dtype=complex)
        bad = kernels.answer_and_derivatives(
            *self._condensed, coefficients[0], amounts[0], z, by_coefficient, by_amount
        )
        if bad >= 0:
            self._refuse(coefficients[0], amounts[0], 0)
        by = by_coefficient.reshape(groups, 2, 2, 2, self.probes, speeds).swapaxes(-1, -2)
        return ReceptanceDerivatives(z.T, by[:, 0], by[:, 1], by_amount.swapaxes(-1, -2))

    @property
    def _condensed(self) -> tuple[Real, Real, NDArray[np.int64], complex]:
        return self.H, self.omega, self.group, self.reference

    def _answer(self, coefficients: Real, amounts: Complex, shape: tuple[int, ...]) -> Complex:
        out = np.empty((len(coefficients), len(self.omega), self.probes), dtype=complex)
        bad = kernels.answer(*self._condensed, coefficients, amounts, out)
        if bad >= 0:
            self._refuse(coefficients[bad], amounts[bad], bad)
        return out.reshape(shape + out.shape[1:])

    def _diagonal(
        self, kxx: ArrayLike, kyy: ArrayLike, cxx: ArrayLike, cyy: ArrayLike, u: ArrayLike
    ) -> tuple[Real, Complex, tuple[int, ...]]:
        """Return coefficients (candidate, group, 8), amounts (candidate, load) and the shape of the candidates."""
        shape = np.broadcast(kxx, kyy, cxx, cyy, u).shape
        if not shape:  # one candidate: what follows would take longer than its answer
            one = (kxx, 0.0, 0.0, kyy, cxx, 0.0, 0.0, cyy)
            return np.array([[one] * len(self.groups)], dtype=float), np.array([[u] * self.loads], dtype=complex), shape
        coefficients = np.zeros((*shape, len(self.groups), kernels.COEFFICIENTS))
        for place, value in zip(_DIRECT, (kxx, kyy, cxx, cyy), strict=True):
            coefficients[..., place] = np.expand_dims(value, -1)
        amounts = np.empty((*shape, self.loads), dtype=complex)
        amounts[...] = np.expand_dims(u, -1)
        return coefficients.reshape(-1, *coefficients.shape[-2:]), amounts.reshape(-1, self.loads), shape

    def _general(self, K: ArrayLike, C: ArrayLike, u: ArrayLike) -> tuple[Real, Complex, tuple[int, ...]]:
        K, C, u = np.asarray(K, dtype=float), np.asarray(C, dtype=float), np.asarray(u, dtype=complex)
        groups = len(self.groups)
        for label, values, want in (("K", K, (groups, 2, 2)), ("C", C, (groups, 2, 2)), ("u", u, (self.loads,))):
            if values.shape[-len(want) :] != want:
                raise ValueError(f"{label} has shape {values.shape}, want (..., {', '.join(map(str, want))})")
        shape: tuple[int, ...] = ()
        if (K.ndim, C.ndim, u.ndim) != (3, 3, 1):
            shape = np.broadcast_shapes(K.shape[:-3], C.shape[:-3], u.shape[:-1])
            K, C = np.broadcast_to(K, (*shape, *K.shape[-3:])), np.broadcast_to(C, (*shape, *C.shape[-3:]))
            u = np.broadcast_to(u, (*shape, self.loads))
        coefficients = np.concatenate([K.reshape(-1, groups, 4), C.reshape(-1, groups, 4)], axis=-1)
        return coefficients, np.ascontiguousarray(u.reshape(-1, self.loads)), shape

    def _refuse(self, coefficients: Real, amounts: Complex, candidate: int) -> NoReturn:
        """Raise what is wrong with a candidate the kernels could not use."""
        for names, values in zip(self.groups, coefficients, strict=True):
            where = f"candidate {candidate}: bearing {', '.join(names)}"
            if not np.isfinite(values).all():
                raise ValueError(f"{where}: coefficients are {values}, want finite ones")
            if values[_DIRECT].min() < 0:
                raise ValueError(f"{where}: kxx, kyy, cxx, cyy are {values[_DIRECT]}, want zero or more")
        if not np.isfinite(amounts).all():
            raise ValueError(f"candidate {candidate}: amounts are {amounts}, want finite ones")
        raise DataError(
            f"candidate {candidate}: an undamped resonance lies on one of the speeds, "
            f"{self.omega.min() * RPM:.6g} to {self.omega.max() * RPM:.6g} rpm, want damping or other speeds"
        )


def condense(model: RotorModel, omega: ArrayLike, *, bearings: Sequence[str], disk: str) -> Receptance:
    """Return the receptances of `model` for changing `bearings`, all alike, and an unbalance on `disk`, or plane.

    Raises ValueError on an unknown name or no bearing, ConfigError on a bearing whose coefficients depend on speed.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    direction = unbalance_direction(model.plane(disk), model.rotation)
    return condense_groups(model, omega, groups=[bearings], forces=omega[:, None, None] ** 2 * direction[:, None])


def condense_groups(
    model: RotorModel, omega: ArrayLike, *, groups: Sequence[Sequence[str]], forces: ArrayLike
) -> Receptance:
    """Return the receptances for `groups` of bearings, alike within a group, and `forces` of changing amounts.

    `forces` (speed, dof, load) are 1X phasors per unit of each amount: Omega^2 (1, -j) on a disk for an unbalance in
    kg m, likewise of a bow (loads.bow_force) or from outside; one row serves all speeds. Raises as `condense`.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    names = [name for group in groups for name in group]
    if not names or not all(groups):
        raise ValueError("bearings is empty, want the names of those that change")
    if len(set(names)) < len(names):
        raise ValueError(f"bearings are {names}, want each of them once")
    attached = [model.bearing(name) for name in names]
    stiffness = max(SOFTEST_REFERENCE, *(float(b.K.diagonal().max()) for b in attached))
    reference = stiffness * (1 + 1j)
    rows = np.vstack([b.rows for b in attached])
    bare = with_bearing(model, names, np.zeros((2, 2)), np.zeros((2, 2)))
    forces = np.asarray(forces, dtype=complex)
    if forces.ndim != 3 or forces.shape[0] not in (1, len(omega)) or forces.shape[1] != model.dof or not forces.size:
        raise ValueError(
            f"forces have shape {forces.shape}, want (speed, dof, load) = ({len(omega)}, {model.dof}, 1..)"
        )
    response = _at_reference(bare, rows, reference, omega, np.broadcast_to(forces, (len(omega), *forces.shape[1:])))
    H = np.moveaxis(np.vstack([rows, model.probes]) @ response, 0, -1)
    return Receptance(
        omega=omega,
        groups=tuple(tuple(group) for group in groups),
        loads=forces.shape[-1],
        probes=len(model.probes),
        H=np.ascontiguousarray([H.real, H.imag]),
        group=np.repeat(np.arange(len(groups)), [len(group) for group in groups]),
        reference=reference,
    )


def _at_reference(bare: RotorModel, rows: Real, reference: complex, omega: Real, forces: Complex) -> Complex:
    """Return the response to unit forces along `rows` and to `forces`, (speed, dof, row + load), bearings at d0."""
    response = np.empty((len(omega), bare.dof, len(rows) + forces.shape[-1]), dtype=complex)
    constant = all(bearing.constant for bearing in bare.bearings)
    for i, speed in enumerate(omega):
        if i == 0 or not constant:
            powers, band = _store_banded(_powers(bare, speed, reference * (rows.T @ rows)))
        Z = powers[0] + speed * powers[1] + speed**2 * powers[2]
        loads = np.hstack([rows.T, forces[i]])
        try:
            response[i] = _solve_banded(band, Z, loads) if band else np.linalg.solve(Z, loads)
        except np.linalg.LinAlgError as error:  # the reference damps all that its bearings can hold
            raise DataError(
                f"at {speed * RPM:.6g} rpm the bearings do not hold the rotor, want more of them"
            ) from error
    return response


def _solve_banded(band: int, Z: Complex, loads: Complex) -> Complex:
    """Return Z^-1 loads; Z (3 band + 1, dof) as `_banded` stores it, which scipy.linalg.solve_banded would copy."""
    _, _, x, singular = lapack.zgbsv(band, band, Z, loads, overwrite_ab=True)
    if singular:
        raise np.linalg.LinAlgError(f"pivot {singular} is nil")
    return x


def _powers(model: RotorModel, speed: float, added: NDArray[np.complexfloating]) -> Powers:
    """Return the coefficients of the dynamic stiffness as a polynomial in Omega, (dof, dof) each, power 0 first."""
    M, C, G, K = matrices(model, speed)
    H, S = speed_stiffness(model)
    return K + 1j * hysteretic(model) + added, 1j * C + H, 1j * G + S - M


def _store_banded(powers: Powers) -> tuple[Powers, int]:
    """Return matrices in LAPACK's band form and the width of the band to either side, or as they are and 0.

    The form is that of gbsv: above the bands there is room for those that pivoting adds.
    """
    row, column = np.nonzero(sum(A != 0 for A in powers))
    band, dof = int(np.abs(row - column).max()), len(powers[0])
    if dof < _NARROW * (2 * band + 1):
        return powers, 0
    stored = []
    for A in powers:
        ab = np.zeros((3 * band + 1, dof), dtype=complex, order="F")
        ab[2 * band + row - column, column] = A[row, column]
        stored.append(ab)
    return tuple(stored), band
